import { expect, it } from 'vitest';
import { closed, isAtStart, withCorner, withoutCorner, withPointerAt } from './polygon.ts';

/** Three corners, and the pointer elsewhere. */
const drawn = withPointerAt(
  [
    [10, 0],
    [20, 0],
    [15, 9],
  ].reduce<ReturnType<typeof withPointerAt> | null>(
    (polygon, [x, y]) => withCorner(withPointerAt(polygon, [x, y])),
    null,
  ),
  [4, 5],
);

it('has a corner wherever one was set, and goes on to the pointer until it is closed', () => {
  expect(drawn.points).toEqual([10, 0, 20, 0, 15, 9, 4, 5]);
  expect(closed(drawn)?.points).toEqual([10, 0, 20, 0, 15, 9]);
});

it('takes the last corner back until none is left', () => {
  const two = withoutCorner(drawn);
  expect(two?.points).toEqual([10, 0, 20, 0, 4, 5]);
  expect(two && closed(two)).toBeNull();
  const one = two && withoutCorner(two);
  expect(one?.points).toEqual([10, 0, 4, 5]);
  expect(one && withoutCorner(one)).toBeNull();
});

it('is closed by a pointer at its first corner, once it has three', () => {
  expect(isAtStart(withPointerAt(drawn, [13, 4]), 5)).toBe(true);
  expect(isAtStart(withPointerAt(drawn, [13, 4.1]), 5)).toBe(false);
  const two = withoutCorner(withPointerAt(drawn, [10, 0]));
  expect(two && isAtStart(two, 5)).toBe(false);
});
