import { expect, test } from 'vitest';
import { closestNames } from './hard-cases.ts';

test('puts the closest name first and leaves out what is not alike', () => {
  const names = ['needle-aspect-1e6', 'needle-edge-on', 'far-origin', 'cut-off', 'equal-keys', 'in-a-room'];
  expect(closestNames(names, 'origin-far')).toEqual(['far-origin']);
  expect(closestNames(names, '')).toEqual([]);
});
