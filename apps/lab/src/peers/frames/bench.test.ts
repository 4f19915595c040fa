import { expect, test } from 'vitest';
import { isReadBy } from './bench.ts';

const spz = (variant: string) => ({ name: 'spz', variant });

test('a peer reads the formats that it names, in all variants or in some', () => {
  expect(isReadBy('any', spz('4'))).toBe(true);
  expect(isReadBy(['ply', 'spz'], spz('4'))).toBe(true);
  expect(isReadBy(['ply', 'spz 2', 'spz 3'], spz('3'))).toBe(true);
  expect(isReadBy(['ply', 'spz 2', 'spz 3'], spz('4'))).toBe(false);
  expect(isReadBy(['compressed-ply'], { name: 'ply', variant: '' })).toBe(false);
});
