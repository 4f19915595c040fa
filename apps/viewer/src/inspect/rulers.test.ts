import { expect, it } from 'vitest';
import { undoEdit } from '../state/make-edit.ts';
import { EditHistory } from './edit-history.ts';
import { fakeTools } from './inspect-tools.fixture.ts';
import { Rulers, rulerLength } from './rulers.ts';

function rulersOf({ storage = new Map<string, string>(), contentKey = 'a' } = {}) {
  const fake = fakeTools({ point: [0, 0, 0] });
  fake.store.setState({ scene: { contentKey } as never });
  const kept = {
    getItem: (key: string) => storage.get(key) ?? null,
    setItem: (key: string, value: string) => void storage.set(key, value),
    removeItem: (key: string) => void storage.delete(key),
  };
  const rulers = new Rulers({ ...fake.tools, storage: () => kept }, new EditHistory(fake.tools));
  const markAt = async (point: readonly [number, number, number] | null) => {
    fake.viewer.pickAt.mockResolvedValueOnce(point && ({ point } as never));
    await rulers.markAt(0.5, 0.5);
  };
  return { ...fake, rulers, markAt, storage };
}

it('two places make a ruler; a place without a splat makes nothing', async () => {
  const { store, rulers, markAt, inspecting } = rulersOf();
  await markAt(null);
  expect(inspecting()).toMatchObject({ rulerStart: null, problem: expect.stringContaining('No splat') });
  await markAt([1, 0, 0]);
  expect(inspecting()).toMatchObject({ rulerStart: [1, 0, 0], rulers: [], problem: null });
  await markAt([1, 3, 4]);
  expect(inspecting().rulerStart).toBeNull();
  const [ruler] = inspecting().rulers;
  expect(rulerLength(ruler)).toBe(5);
  await markAt([0, 0, 0]);
  rulers.forgetStart();
  expect(inspecting().rulerStart).toBeNull();
  rulers.remove(ruler);
  expect(inspecting().rulers).toEqual([]);
  undoEdit(store);
  expect(inspecting().rulers).toEqual([ruler]);
  undoEdit(store);
  expect(inspecting().rulers).toEqual([]);
});

it('places are kept in the scene’s own space, whatever way up it is shown', async () => {
  const { store, markAt, inspecting } = rulersOf();
  store.setState({ isFlipped: true });
  await markAt([1, 2, 3]);
  expect(inspecting().rulerStart).toEqual([1, -2, -3]);
});

it('a known length sets the scale, which comes again with the scene, and goes', async () => {
  const { rulers, markAt, inspecting, storage } = rulersOf();
  await markAt([0, 0, 0]);
  await markAt([2, 0, 0]);
  const [ruler] = inspecting().rulers;
  expect(rulers.calibrate(ruler, Number.NaN, 'm')).toBe(false);
  expect(inspecting().scale).toBeNull();
  expect(rulers.calibrate(ruler, 1, 'm')).toBe(true);
  const again = rulersOf({ storage });
  again.rulers.readScale();
  expect(again.inspecting().scale).toEqual({ perSceneUnit: 0.5, unit: 'm' });
  const other = rulersOf({ storage, contentKey: 'b' });
  other.rulers.readScale();
  expect(other.inspecting().scale).toBeNull();
  again.rulers.forgetScale();
  expect(again.inspecting().scale).toBeNull();
  expect(storage.size).toBe(0);
  undoEdit(again.store);
  expect([again.inspecting().scale?.unit, storage.size]).toEqual(['m', 1]);
});

it('works where the browser may keep nothing', async () => {
  const { tools, inspecting } = rulersOf();
  const storage = () => {
    throw new Error('not allowed');
  };
  const rulers = new Rulers({ ...tools, storage }, new EditHistory(tools));
  rulers.readScale();
  rulers.calibrate(
    {
      id: 1,
      ends: [
        [0, 0, 0],
        [1, 0, 0],
      ],
    },
    3,
    'ft',
  );
  expect(inspecting().scale).toEqual({ perSceneUnit: 3, unit: 'ft' });
});
