import { expect, test } from 'vitest';
import { i420Of } from './video-writer.ts';

const image = (...colors: (readonly [number, number, number])[]) =>
  Uint8ClampedArray.from(colors.flatMap((color) => [...color, 255]));

// Rounded from the matrix of BT.709, in the range of videos.
test.each([
  [
    [0, 0, 0],
    [16, 128, 128],
  ],
  [
    [255, 255, 255],
    [235, 128, 128],
  ],
  [
    [255, 0, 0],
    [63, 102, 240],
  ],
  [
    [0, 255, 0],
    [173, 42, 26],
  ],
  [
    [0, 0, 255],
    [32, 240, 118],
  ],
] as const)('%j is %j: brightness, and differences of blue and red', (color, [bright, blue, red]) => {
  expect([...i420Of(image(color, color, color, color), 2, 2)]).toEqual([
    ...[bright, bright, bright, bright],
    ...[blue, red],
  ]);
});

test('each pixel has its brightness, and four share their colour', () => {
  const [white, black, red] = [
    [255, 255, 255],
    [0, 0, 0],
    [255, 0, 0],
  ] as const;
  expect([...i420Of(image(white, black, red, red, black, white, red, red), 4, 2)]).toEqual([
    ...[235, 16, 63, 63, 16, 235, 63, 63],
    ...[128, 102],
    ...[128, 240],
  ]);
});
