import { expect, test } from 'vitest';
import { upscale } from './compose.reference.ts';

test('interpolates a smaller image between the middles of its pixels', () => {
  const upscaled = upscale([0, 100], { widthPx: 2, heightPx: 1 }, { widthPx: 4, heightPx: 2 });
  expect([...upscaled]).toEqual([0, 25, 75, 100, 0, 25, 75, 100]);
});
