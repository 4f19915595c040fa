import { expect, it } from 'vitest';
import { BLACK, shownBytes } from './shown-pixels.ts';

it('puts an image on its background', () => {
  const image = Float32Array.of(0, 0, 0, 0, 0.25, 0, 0, 0.5, 1, 1, 1, 1);
  expect([...shownBytes(image, [1, 0, 0.4])]).toEqual([
    255, 0, 102, 255, 191, 0, 51, 255, 255, 255, 255, 255,
  ]);
});

it('shows what no screen can show as far as it can', () => {
  expect([...shownBytes([0.5, 2, -1, 0.2], BLACK)]).toEqual([128, 255, 0, 255]);
});
