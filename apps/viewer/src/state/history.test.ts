import { expect, it } from 'vitest';
import { History, historyKey, replacement, type Steps } from './history.ts';

function counting(most: number) {
  let shown = 0;
  let steps: Steps = { past: [], undone: [] };
  const now = () => shown;
  const show = (value: number, next: Steps) => {
    [shown, steps] = [value, next];
  };
  const history = new History(() => steps, most);
  const take = (value: number, gesture?: unknown) =>
    history.take(replacement(`to ${value}`, value, now, show), gesture);
  const names = () => [steps.past, steps.undone].map((edits) => edits.map(({ name }) => name).join());
  return { history, take, names, now, set: (value: number) => show(value, steps) };
}

it('keeps the newest edits, and forgets undone ones at the next edit', () => {
  const { history, take, names, now } = counting(2);
  for (const value of [1, 2, 3]) take(value);
  expect(names()).toEqual(['to 2,to 3', '']);
  for (let i = 0; i < 3; i++) history.undo();
  expect([now(), ...names()]).toEqual([1, '', 'to 3,to 2']);
  history.redo();
  take(4);
  history.redo();
  expect([now(), ...names()]).toEqual([4, 'to 2,to 4', '']);
});

it('undoes successive edits of a gesture together, under the name of the last', () => {
  const { history, take, names, now } = counting(5);
  const gesture = {};
  take(1);
  for (const value of [2, 3]) take(value, gesture);
  expect(names()).toEqual(['to 1,to 3', '']);
  history.undo();
  expect(now()).toBe(1);
  history.redo();
  expect(now()).toBe(3);
});

it('brings back changes that no edit made', () => {
  const { history, take, now, set } = counting(5);
  take(1);
  set(7);
  history.undo();
  expect(now()).toBe(0);
  history.redo();
  expect(now()).toBe(7);
});

it('reads the direction of key presses', () => {
  const press = (key: string, modifiers: string) =>
    historyKey({
      key,
      ctrlKey: modifiers.includes('c'),
      metaKey: modifiers.includes('m'),
      shiftKey: modifiers.includes('s'),
      altKey: modifiers.includes('a'),
    });
  expect(['c', 'm', 'cs', 'ca', ''].map((each) => press('z', each))).toEqual([
    'undo',
    'undo',
    'redo',
    null,
    null,
  ]);
  expect([press('Z', 'cs'), press('y', 'c'), press('y', 'cs'), press('x', 'c')]).toEqual([
    'redo',
    'redo',
    null,
    null,
  ]);
});
