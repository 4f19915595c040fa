import { describe, expect, test } from 'vitest';
import { orderFlaw } from './compare-order.ts';

const KEYS = Uint32Array.of(5, 1, 5, 3);

test('the stable ascending order has no flaw', () => {
  expect(orderFlaw(KEYS, Uint32Array.of(1, 3, 0, 2))).toBeNull();
  expect(orderFlaw(new Uint32Array(), new Uint32Array())).toBeNull();
});

test.each([
  ['a swapped pair', [3, 1, 0, 2]],
  ['a duplicate key', [1, 3, 0, 0]],
  ['an unstable pair', [1, 3, 2, 0]],
  ['an index out of range', [1, 3, 0, 4]],
  ['a missing place', [1, 3, 0]],
])('%s is a flaw', (_, order) => {
  expect(orderFlaw(KEYS, Uint32Array.from(order))).not.toBeNull();
});

describe('keys known within bounds', () => {
  const key = (least: number, most = least) => ({ least, most });
  const bounds = [key(2, 4), key(3, 5), key(7), key(7), key(6, 8)];

  test.each([[[0, 1, 2, 3, 4]], [[1, 0, 4, 2, 3]], [[0, 1, 2, 4, 3]]])('%j is possible', (order) => {
    expect(orderFlaw(bounds, Uint32Array.from(order))).toBeNull();
  });

  test.each([
    ['a key that is surely less than one before', [2, 0, 1, 3, 4]],
    ['one that is so by more than its neighbour', [0, 2, 4, 1, 3]],
    ['an unstable pair', [0, 1, 3, 2, 4]],
    ['an unstable pair around another key', [0, 1, 3, 4, 2]],
    ['a missing place', [0, 1, 2, 3]],
  ])('%s is a flaw', (_, order) => {
    expect(orderFlaw(bounds, Uint32Array.from(order))).not.toBeNull();
  });
});
