import { expect, it, vi } from 'vitest';
import { redoEdit, undoEdit } from '../state/make-edit.ts';
import { PLAIN_LOOK } from '../state/scene-part.ts';
import { countOf } from '../state/selecting.ts';
import { EditHistory } from './edit-history.ts';
import { fakeTools } from './inspect-tools.fixture.ts';
import { type SplitTools, splitSelection } from './split-selection.ts';

function splitting() {
  const fake = fakeTools();
  const partOf = (key: number, name: string) => ({
    key,
    look: { ...PLAIN_LOOK, opacity: 0.5 },
    source: { kind: 'file', name, source: new File([], name) },
    loaded: { clouds: [] },
  });
  const scenes = {
    newest: {
      parts: [partOf(3, 'a.ply'), partOf(4, 'b.spz')],
    } as unknown as SplitTools['viewer']['scenes']['newest'],
    newKey: () => 9,
    addAgain: vi.fn<(...parts: unknown[]) => void>(),
    remove: vi.fn(),
  };
  const history = new EditHistory(fake.tools);
  history.edit('selection', { selected: new Map([['4/0', Uint32Array.of(0b1011)]]) });
  const write = vi.fn<SplitTools['write']>(async () => new Blob(['ply']));
  const { store, tools } = fake;
  const split = () => splitSelection({ store, update: tools.update, viewer: { scenes }, write }, history);
  const counts = () => {
    const { selected, removed } = fake.inspecting().selecting;
    return [countOf(selected), countOf(removed)];
  };
  return { ...fake, scenes, write, split, counts };
}

it('makes the selected splats a file of their own, in one edit', async () => {
  const { store, scenes, write, split, counts } = splitting();
  await split();
  const [{ parts, crop }] = write.mock.lastCall!;
  expect(crop).toBeNull();
  // Files without a selected splat are not read.
  expect(parts).toEqual([
    expect.objectContaining({ opacity: 0.5, rows: { words: Uint32Array.of(0b1011), areSaved: true } }),
  ]);
  expect(scenes.addAgain).toHaveBeenLastCalledWith({
    key: 9,
    look: PLAIN_LOOK,
    source: { kind: 'file', name: 'Part of b.ply', source: expect.any(File) },
  });
  expect(counts()).toEqual([0, 3]);
  expect(store.getState()).toMatchObject({ dock: 'clouds', selectedPart: 9 });
  undoEdit(store);
  expect(scenes.remove).toHaveBeenCalledExactlyOnceWith(9);
  expect(counts()).toEqual([3, 0]);
  redoEdit(store);
  expect(scenes.addAgain).toHaveBeenCalledTimes(2);
  expect(counts()).toEqual([0, 3]);
});

it('leaves everything as it is where the file cannot be written', async () => {
  const { scenes, write, split, counts, inspecting } = splitting();
  write.mockRejectedValue(new Error('b.spz has gone.'));
  await split();
  expect(inspecting().problem).toContain('b.spz has gone.');
  expect(counts()).toEqual([3, 0]);
  expect(scenes.addAgain).not.toHaveBeenCalled();
});
