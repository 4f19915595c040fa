import type { EffectUse, SplatSelection, Volume } from '@websplatter/core/effects';
import { expect, it } from 'vitest';
import type { CloudEffects } from '../state/effects.ts';
import type { Crop } from '../state/inspecting.ts';
import { redoEdit, undoEdit } from '../state/make-edit.ts';
import type { RowMasks } from '../state/selecting.ts';
import { EditHistory } from './edit-history.ts';
import { fakeTools } from './inspect-tools.fixture.ts';

const cropTo = (x: number): Crop => ({ min: [0, 0, 0], max: [x, 1, 1], keep: 'inside' });
const rows = (word: number): RowMasks => new Map([['3/0', Uint32Array.of(word)]]);

function editing() {
  const fake = fakeTools();
  // As the viewer does: what is asked for is known before it is drawn.
  fake.viewer.setEffects.mockImplementation((name, uses) =>
    fake.store.setState(({ requested }) => ({ requested: { ...requested, [name]: uses } })),
  );
  const requested = () => fake.store.getState().requested;
  const drawnWidth = () =>
    (requested().crop as EffectUse[]).flatMap(({ options }) =>
      (options as readonly Volume[]).map((volume) => volume.shape === 'box' && volume.size?.[0]),
    )[0];
  const hidden = () =>
    [...(requested().removed as CloudEffects).values()].map(([use]) => (use.options as SplatSelection).size);
  return { ...fake, history: new EditHistory(fake.tools), drawnWidth, hidden };
}

it('steps back and forth through crops and removals, in the picture too', () => {
  const { store, history, inspecting, drawnWidth, hidden } = editing();
  history.edit('Crop', { crop: cropTo(5) });
  history.edit('Remove', { removed: rows(0b11) });
  history.edit('Crop', { crop: cropTo(3) });
  expect([drawnWidth(), hidden()]).toEqual([3, [2]]);
  undoEdit(store);
  expect([drawnWidth(), hidden()]).toEqual([5, [2]]);
  undoEdit(store);
  expect([drawnWidth(), hidden()]).toEqual([5, []]);
  undoEdit(store);
  undoEdit(store);
  expect([drawnWidth(), inspecting().crop]).toEqual([undefined, null]);
  for (let i = 0; i < 4; i++) redoEdit(store);
  expect([drawnWidth(), hidden()]).toEqual([3, [2]]);
  // An edit takes the place of what was undone.
  undoEdit(store);
  history.edit('Select', { selected: rows(1) });
  redoEdit(store);
  expect(drawnWidth()).toBe(5);
});

it('takes the changes of one gesture in a row as one step', () => {
  const { store, history, inspecting } = editing();
  const [drag, next] = [{}, {}];
  for (const x of [1, 2, 3]) history.edit('Crop', { crop: cropTo(x) }, drag);
  expect(history.before(drag).crop).toBeNull();
  for (const x of [4, 5]) history.edit('Crop', { crop: cropTo(x) }, next);
  history.edit('Crop', { crop: cropTo(6) });
  history.edit('Crop', { crop: cropTo(7) });
  const widths: (number | undefined)[] = [];
  for (let i = 0; i < 5; i++) {
    widths.push(inspecting().crop?.max[0]);
    undoEdit(store);
  }
  expect(widths).toEqual([7, 6, 5, 3, undefined]);
  // What is undone ends the gesture.
  history.edit('Crop', { crop: cropTo(8) }, next);
  undoEdit(store);
  history.edit('Crop', { crop: cropTo(9) }, next);
  expect(store.getState().past).toHaveLength(1);
});
