import { InvalidArgumentError } from '@websplatter/core';
import { expect, test } from 'vitest';
import { checkedReveal, type RevealAnimation } from './reveal-animation.ts';

test('a valid animation is returned as it is', () => {
  const animation: RevealAnimation = { from: 'camera', durationMs: 100, softEdge: 0 };
  expect(checkedReveal(animation)).toBe(animation);
});

test.each<[string, Partial<RevealAnimation>]>([
  ['durationMs', { durationMs: 0 }],
  ['durationMs', { durationMs: Number.POSITIVE_INFINITY }],
  ['durationMs', { durationMs: Number.NaN }],
  ['from', { from: [0, 1, Number.NaN] }],
  ['softEdge', { softEdge: -1 }],
  // Of a reveal without a time.
  ['reveal', { radius: 3 } as never],
])('rejects an invalid %s', (argument, options) => {
  const check = () => checkedReveal({ from: 'camera', durationMs: 1, ...options });
  expect(check).toThrow(InvalidArgumentError);
  expect(check).toThrow(expect.objectContaining({ argument }));
});
