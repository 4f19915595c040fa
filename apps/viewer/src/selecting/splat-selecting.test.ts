import { perspectiveCamera } from '@websplatter/core';
import type { SplatSelection } from '@websplatter/core/effects';
import { expect, it } from 'vitest';
import { EditHistory } from '../inspecting/edit-history.ts';
import { fakeTools } from '../inspecting/inspect-tools.fixture.ts';
import type { CloudEffects } from '../state/requested-effects.ts';
import { PLAIN_LOOK } from '../state/scene-part.ts';
import { countOf } from './row-masks.ts';
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
      (use.options as SplatSelection).count,
    ]);
  return { ...fake, selecting, history, now, counts, hidden };
}

it('selects what a drag covers as the image shows it, of the clouds that are drawn', async () => {
  const { selecting, ask, now, counts } = selectingOf(0b11, 0b1000);
  const dragged = { kind: 'rectangle', from: [1, 2], to: [3, 4] } as const;
  await selecting.selectDragged(dragged, 30, 20, 'replace');
  expect(ask.mock.lastCall).toEqual([
    'within',
    { region: expect.objectContaining({ kind: 'dragged', dragged, width: 30, height: 20 }), crop: null },
  ]);
  expect([...now().selected.keys()]).toEqual(['3/0', '5/0']);
  expect(counts()).toEqual([3, 0]);
  selecting.clear();
  expect(counts()).toEqual([0, 0]);
});

it('removes what is selected from the picture, inverts what is left, and undoes each step', async () => {
  const { selecting, history, ask, counts, hidden } = selectingOf(0b11, 0);
  await selecting.select({ kind: 'all' });
  selecting.remove();
  expect(counts()).toEqual([0, 2]);
  expect(hidden()).toEqual([['3/0', 2]]);
  ask.mockResolvedValue([Uint32Array.of(0b1111), Uint32Array.of(1)]);
  await selecting.invert();
  expect(counts()).toEqual([3, 2]);
  selecting.remove();
  expect(counts()).toEqual([0, 5]);
  history.undo();
  expect(counts()).toEqual([3, 2]);
  expect(hidden()).toEqual([['3/0', 2]]);
  history.redo();
  history.redo();
  expect(counts()).toEqual([0, 5]);
  history.undo();
  history.undo();
  selecting.restore();
  expect(counts()).toEqual([0, 0]);
  expect(hidden()).toEqual([]);
  for (let i = 0; i < 9; i++) history.undo();
  expect(counts()).toEqual([0, 0]);
  // An edit takes the place of what was undone.
  await selecting.select({ kind: 'all' });
  history.redo();
  expect(counts()).toEqual([5, 0]);
});

it('says where no splat is, and changes nothing where the scene cannot be read', async () => {
  const { selecting, ask, inspecting, now } = selectingOf(0, 0);
  await selecting.selectSeen();
  expect(inspecting().problem).toContain('No splat');
  const before = now();
  ask.mockResolvedValue(undefined);
  await selecting.select({ kind: 'all' });
  await selecting.invert();
  expect(now()).toBe(before);
});
