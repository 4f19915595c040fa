import { expect, test } from 'vitest';
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
