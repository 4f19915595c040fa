import { expect, it } from 'vitest';
import { onBackground } from './thumbnail.ts';

it('puts an image on its background', () => {
  const image = Float32Array.of(0, 0, 0, 0, 0.25, 0, 0, 0.5, 1, 1, 1, 1);
  expect([...onBackground(image, [1, 0, 0.4])]).toEqual([
    255, 0, 102, 255, 191, 0, 51, 255, 255, 255, 255, 255,
  ]);
});
