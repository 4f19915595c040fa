import { expect, it } from 'vitest';
import { dayAndTime } from './kept-panels.tsx';

it('says the day in words while it is near', () => {
  const now = new Date(2026, 10, 30, 0, 10).getTime();
  const at = (...time: [number, number, number, number, number]) =>
    dayAndTime(new Date(...time).getTime(), now);
  expect(at(2026, 10, 30, 0, 5)).toBe('today, 00:05');
  expect(at(2026, 10, 29, 23, 59)).toBe('yesterday, 23:59');
  expect(at(2026, 10, 28, 18, 20)).toBe('28 Nov 2026, 18:20');
  // A clock that was set back.
  expect(at(2026, 11, 1, 9, 0)).toBe('1 Dec 2026, 09:00');
});
