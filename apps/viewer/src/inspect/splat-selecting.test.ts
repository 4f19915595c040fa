import { perspectiveCamera, type SplatPick } from '@websplatter/core';
import type { SplatSelection } from '@websplatter/core/effects';
import { colorDcOf } from '@websplatter/core/own-data';
import { expect, it, vi } from 'vitest';
import type { CloudEffects } from '../state/effects.ts';
import { redoEdit, undoEdit } from '../state/make-edit.ts';
import { PLAIN_LOOK } from '../state/scene-part.ts';
import type { PickedRegion } from '../state/selecting.ts';
import { countOf } from '../state/selecting.ts';
import { EditHistory } from './edit-history.ts';
import { fakeTools } from './inspect-tools.fixture.ts';
import { SplatSelecting } from './splat-selecting.ts';

const camera = perspectiveCamera({ position: [0, 0, 5], target: [0, 0, 0], aspect: 1, fovYDegrees: 50 });

/** Two files of a cloud each are drawn, and a hidden one; `found` lies in the requested region. */
function selectingOf(...found: readonly number[]) {
  const fake = fakeTools();
  const part = (key: number, isHidden = false) => ({
    key,
    look: { ...PLAIN_LOOK, isHidden },
    loaded: { clouds: [{}] },
  });
  Object.assign(fake.viewer.scenes, { newest: { parts: [part(3), part(4, true), part(5)] } });
  Object.assign(fake.viewer, { shownFrame: { frame: { camera } } });
  fake.ask.mockResolvedValue(found.map((word) => Uint32Array.of(word)));
  const history = new EditHistory(fake.tools);
  const selecting = new SplatSelecting(fake.tools, history);
  const now = () => fake.inspecting().selecting;
  const counts = () => [countOf(now().selected), countOf(now().removed)];
  const hidden = () =>
    [...((fake.viewer.setEffects.mock.lastCall?.[1] ?? []) as CloudEffects)].map(([key, [use]]) => [
      key,
      (use.options as SplatSelection).size,
    ]);
  return { ...fake, selecting, history, now, counts, hidden };
}

it('selects what a drag covers as the image shows it, of the clouds that are drawn', async () => {
  const { selecting, ask, now, counts } = selectingOf(0b11, 0b1000);
  const dragged = { kind: 'rectangle', from: [1, 2], to: [3, 4] } as const;
  await selecting.selectDragged(dragged, 30, 20, 'replace');
  expect(ask.mock.lastCall?.slice(0, 2)).toEqual([
    'within',
    { region: expect.objectContaining({ kind: 'dragged', dragged, width: 30, height: 20 }), crop: null },
  ]);
  expect([...now().selected.keys()]).toEqual(['3/0', '5/0']);
  expect(counts()).toEqual([3, 0]);
  selecting.clear();
  expect(counts()).toEqual([0, 0]);
});

it('tells the share of the selected splats that others hide, of those in the picture', async () => {
  const { viewer, selecting, ask } = selectingOf(0b1111, 0);
  await selecting.select({ kind: 'all' });
  ask.mockResolvedValue([
    [0, 0, 0],
    [0, 0, -1],
    [1, 0, 0],
    [900, 0, 0],
  ]);
  const coverage = vi.fn(async (asked: readonly { readonly point: readonly number[] }[]) =>
    asked.map(({ point: [x, , z] }) => ({ isInImage: x < 900, opacity: z < 0 ? 0.9 : 0.1 })),
  );
  Object.assign(viewer, { askShown: (view: (of: unknown) => unknown) => view({ coverage }) });
  expect(await selecting.hiddenPart()).toBeCloseTo(1 / 3);
  expect(ask.mock.lastCall?.slice(0, 2)).toEqual([
    'sample',
    { rows: [Uint32Array.of(0b1111), null], most: 256 },
  ]);
  // The frame has gone before the GPU answers.
  Object.assign(viewer, { askShown: async () => null });
  expect(await selecting.hiddenPart()).toBeNull();
});

it('removes what is selected from the picture, inverts what is left, and undoes each step', async () => {
  const { store, selecting, ask, counts, hidden } = selectingOf(0b11, 0);
  await selecting.select({ kind: 'all' });
  selecting.remove();
  expect(counts()).toEqual([0, 2]);
  expect(hidden()).toEqual([['3/0', 2]]);
  ask.mockResolvedValue([Uint32Array.of(0b1111), Uint32Array.of(1)]);
  await selecting.invert();
  expect(counts()).toEqual([3, 2]);
  selecting.remove();
  expect(counts()).toEqual([0, 5]);
  undoEdit(store);
  expect(counts()).toEqual([3, 2]);
  expect(hidden()).toEqual([['3/0', 2]]);
  redoEdit(store);
  redoEdit(store);
  expect(counts()).toEqual([0, 5]);
  undoEdit(store);
  undoEdit(store);
  selecting.restore();
  expect(counts()).toEqual([0, 0]);
  expect(hidden()).toEqual([]);
  for (let i = 0; i < 9; i++) undoEdit(store);
  expect(counts()).toEqual([0, 0]);
  // An edit takes the place of what was undone.
  await selecting.select({ kind: 'all' });
  redoEdit(store);
  expect(counts()).toEqual([5, 0]);
});

/** What the scene was asked for, in order. */
const regionsOf = ({ ask }: ReturnType<typeof selectingOf>) =>
  ask.mock.calls.flatMap(([about, question]) =>
    about === 'within' ? [(question as { region: PickedRegion }).region] : [],
  );

it('selects a sphere around a pick, whose radius changes in the same step, and is that of the next', async () => {
  const fake = selectingOf(0b11, 0);
  const { store, selecting, ask, now, counts, viewer } = fake;
  fake.store.setState({ isFlipped: true });
  viewer.pickAt.mockResolvedValue({ point: [1, 2, 3] } as unknown as SplatPick);
  selecting.choose({ tool: 'sphere', mode: 'add' });
  await selecting.pickAt(0.5, 0.5, 'add');
  // The first is a tenth as large as what the camera looks at.
  expect(now().picked).toEqual({ kind: 'sphere', center: [1, -2, -3], radius: 0.1 });
  expect(counts()).toEqual([2, 0]);
  // Of changes during an answer, the newest counts; what was selected before the pick stays.
  ask.mockResolvedValue([Uint32Array.of(0b100), Uint32Array.of(0)]);
  for (const radius of [1, 2, 3]) selecting.sphereRadius = radius;
  await expect
    .poll(() => regionsOf(fake).map((region) => 'radius' in region && region.radius))
    .toEqual([0.1, 1, 3]);
  await expect.poll(() => counts()).toEqual([1, 0]);
  expect(now().picked).toMatchObject({ radius: 3 });
  await selecting.pickAt(0.1, 0.1, 'subtract');
  expect(now().picked).toMatchObject({ radius: 3 });
  expect(counts()).toEqual([0, 0]);
  // Each pick is undone at once, and can be changed no more.
  undoEdit(store);
  expect(counts()).toEqual([1, 0]);
  expect(now().picked).toBeNull();
  selecting.sphereRadius = 4;
  expect(regionsOf(fake)).toHaveLength(4);
  undoEdit(store);
  expect(counts()).toEqual([0, 0]);
});

it('selects by the base colour of a pick, within a tolerance that changes in the same step', async () => {
  const fake = selectingOf(0b11, 0);
  const { store, selecting, ask, counts, viewer } = fake;
  viewer.pickAt.mockResolvedValue({ cloudIndex: 1, row: 7 } as unknown as SplatPick);
  const found = [Uint32Array.of(0b11), Uint32Array.of(0)];
  ask.mockImplementation(async (about) =>
    about === 'splat' ? { colorDc: Float32Array.from([0.2, 2, -1], colorDcOf) } : found,
  );
  selecting.choose({ tool: 'color' });
  await selecting.pickAt(0.5, 0.5, 'replace');
  expect(ask.mock.calls[0]).toEqual(['splat', { cloudIndex: 1, row: 7 }]);
  selecting.tolerance = 40;
  const color = [51, 255, 0];
  await expect
    .poll(() => regionsOf(fake))
    .toEqual([
      { kind: 'color', color, tolerance: 16 },
      { kind: 'color', color, tolerance: 40 },
    ]);
  await expect.poll(() => counts()).toEqual([2, 0]);
  undoEdit(store);
  expect(counts()).toEqual([0, 0]);
});

it('says where no splat is, and changes nothing where the scene cannot be read', async () => {
  const { store, selecting, ask, inspecting, now } = selectingOf(0, 0);
  await selecting.selectSeen();
  expect(inspecting().problem).toContain('No splat');
  expect(store.getState().past).toEqual([]);
  selecting.choose({ tool: 'sphere' });
  expect(inspecting().problem).toBeNull();
  await selecting.pickAt(0.5, 0.5, 'add');
  expect(inspecting().problem).toContain('No splat is drawn there');
  const before = now();
  ask.mockResolvedValue(undefined);
  await selecting.select({ kind: 'all' });
  await selecting.invert();
  expect(now()).toBe(before);
});
