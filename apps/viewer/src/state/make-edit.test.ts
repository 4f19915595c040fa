import { expect, it } from 'vitest';
import {
  MOST_EDIT_BYTES,
  MOST_EDITS,
  makeEdit,
  recordEdit,
  redoEdit,
  replacement,
  undoEdit,
} from './make-edit.ts';
import { createViewerStore } from './store.ts';

function counting() {
  const store = createViewerStore();
  let shown = 0;
  const now = () => shown;
  const set = (value: number) => {
    shown = value;
  };
  const make = (value: number, gesture?: unknown) =>
    makeEdit(store, replacement(`to ${value}`, value, now, set), gesture);
  const names = () => {
    const { past, undone } = store.getState();
    return [past, undone].map((edits) => edits.map(({ name }) => name).join());
  };
  return { store, make, names, now, set };
}

it('takes edits back and makes them again, and forgets undone ones at the next edit', () => {
  const { store, make, names, now } = counting();
  for (const value of [1, 2, 3]) make(value);
  expect(names()).toEqual(['to 1,to 2,to 3', '']);
  expect([undoEdit(store)?.name, undoEdit(store)?.name]).toEqual(['to 3', 'to 2']);
  expect([now(), ...names()]).toEqual([1, 'to 1', 'to 3,to 2']);
  expect(store.getState().notice).toBe('Undone: to 2.');
  redoEdit(store);
  expect(store.getState().notice).toBe('Redone: to 2.');
  make(4);
  expect(redoEdit(store)).toBeUndefined();
  expect([now(), ...names()]).toEqual([4, 'to 1,to 2,to 4', '']);
});

it('forgets the oldest edits', () => {
  const { store, make, now } = counting();
  for (let value = 1; value <= MOST_EDITS + 2; value++) make(value);
  while (undoEdit(store));
  expect(now()).toBe(2);
});

it('keeps as many edits as have room, and the newest in any case', () => {
  const { store, names } = counting();
  const record = (name: string, bytes: number) =>
    recordEdit(store, { name, bytes, do: () => {}, undo: () => {} });
  for (const name of ['a', 'b', 'c']) record(name, MOST_EDIT_BYTES / 2);
  expect(names()).toEqual(['b,c', '']);
  record('d', MOST_EDIT_BYTES + 1);
  expect(names()).toEqual(['d', '']);
  record('e', 0);
  expect(names()).toEqual(['e', '']);
});

it('undoes successive edits of a gesture together, under the name of the last', () => {
  const { store, make, names, now } = counting();
  const gesture = {};
  make(1);
  for (const value of [2, 3]) make(value, gesture);
  expect(names()).toEqual(['to 1,to 3', '']);
  undoEdit(store);
  expect(now()).toBe(1);
  redoEdit(store);
  expect(now()).toBe(3);
});

it('brings back changes that no edit made', () => {
  const { store, make, now, set } = counting();
  make(1);
  set(7);
  undoEdit(store);
  expect(now()).toBe(0);
  redoEdit(store);
  expect(now()).toBe(7);
});
