import { getEventListeners } from 'node:events';
import { expect, test } from 'vitest';
import { onAbort } from './on-abort.ts';

test('any number of listeners are one of the signal, which goes with the last of them', () => {
  const aborter = new AbortController();
  const { signal } = aborter;
  const told: number[] = [];
  const stops = Array.from({ length: 20 }, (_, i) => onAbort(signal, () => told.push(i)));
  expect(getEventListeners(signal, 'abort')).toHaveLength(1);
  for (const stop of [...stops, ...stops]) stop();
  expect(getEventListeners(signal, 'abort')).toHaveLength(0);
  for (const i of [20, 21, 22]) stops[i] = onAbort(signal, () => told.push(i));
  stops[21]();
  aborter.abort();
  expect(told).toEqual([20, 22]);
  onAbort(signal, () => told.push(23));
  expect(told).toEqual([20, 22]);
});

test('the last listener that is left is still told', () => {
  const aborter = new AbortController();
  const told: number[] = [];
  const [stop] = [0, 1].map((i) => onAbort(aborter.signal, () => told.push(i)));
  stop();
  aborter.abort();
  expect(told).toEqual([1]);
});

test('without a signal nothing is called', () => {
  expect(onAbort(undefined, () => {})()).toBeUndefined();
});
