import type { Vec3 } from '@websplatter/core';
import { ERROR_CLASSES } from '@websplatter/kit/error-classes';
import { describe, expect, it, test } from 'vitest';
import type { ImageOnBackground } from '../engine/viewer.ts';
import { CROP_PX, errorMap, judgePicture, worstPlace } from './error-map.ts';

function imageOf(
  widthPx: number,
  heightPx: number,
  pixel: (x: number, y: number) => readonly number[],
  background: Vec3 = [0, 0, 0],
): ImageOnBackground {
  const data = new Float32Array(4 * widthPx * heightPx);
  for (let y = 0; y < heightPx; y++)
    for (let x = 0; x < widthPx; x++) data.set(pixel(x, y), 4 * (y * widthPx + x));
  return { image: { widthPx, heightPx, data }, background };
}

const grey = (steps: number) => [steps / 255, steps / 255, steps / 255, 1];

describe('error map', () => {
  it('finds nothing between an image and itself', () => {
    const same = imageOf(3, 2, (x, y) => [x / 3, y / 2, 0.25, 0.5]);
    expect(errorMap(same, same).figures).toEqual({ maxSteps: 0, parts: [1, 0, 0, 0, 0, 0] });
  });

  it('classes each pixel by its worst channel', () => {
    const reference = imageOf(6, 1, () => grey(0));
    const actual = imageOf(6, 1, (x) => [0, [0, 1, 2, 4, 8, 40][x] / 255, 0, 1]);
    const { figures, data } = errorMap(actual, reference);
    expect(figures.maxSteps).toBeCloseTo(40);
    expect(figures.parts).toEqual([1, 1, 1, 1, 1, 1].map((count) => count / 6));
    for (let x = 0; x < 6; x++)
      expect([...data.subarray(4 * x, 4 * x + 4)]).toEqual([...ERROR_CLASSES[x].color, 255]);
  });

  it('compares what is seen: on the background, and not beyond white', () => {
    const opaque = imageOf(1, 1, () => [0.5, 0.5, 0.5, 1], [1, 1, 1]);
    const clear = imageOf(1, 1, () => [0, 0, 0, 0.5], [1, 1, 1]);
    expect(errorMap(opaque, clear).figures.maxSteps).toBeCloseTo(0);
    const over = errorMap(
      imageOf(1, 1, () => [7, 1, 1, 1]),
      imageOf(1, 1, () => [1, 1, 1, 1]),
    );
    expect(over.figures.maxSteps).toBe(0);
  });
});

function picture(widthPx: number, heightPx: number, bright: readonly (readonly [x: number, y: number])[]) {
  const data = new Float32Array(4 * widthPx * heightPx);
  for (let at = 3; at < data.length; at += 4) data[at] = 1;
  for (const [x, y] of bright) data[4 * (y * widthPx + x)] = 1;
  return { image: { widthPx, heightPx, data }, background: [0, 0, 0] as const };
}

describe('the worst crop', () => {
  test('is where most of the error is', () => {
    const steps = new Float32Array(320 * 200);
    steps[20 * 320 + 20] = 90;
    for (let i = 0; i < 40; i++) steps[150 * 320 + 200 + i] = 30;
    expect(worstPlace(steps, 320, 200)).toEqual({ xPx: 176, yPx: 88 });
  });

  test('lies within the picture, whose sides need be no multiples of the grid', () => {
    const steps = new Float32Array(131 * 77);
    steps[76 * 131 + 127] = 9;
    expect(worstPlace(steps, 131, 77)).toEqual({ xPx: 64, yPx: 77 - CROP_PX });
  });

  test('is the first of an equal picture, and all of a small one', () => {
    expect(worstPlace(new Float32Array(200 * 100), 200, 100)).toEqual({ xPx: 0, yPx: 0 });
    const { actual, reference, error, whole } = judgePicture(picture(10, 6, [[3, 2]]), picture(10, 6, []));
    for (const each of [actual, reference, error, whole])
      expect(each).toMatchObject({ widthPx: 10, heightPx: 6 });
    const at = 4 * (2 * 10 + 3);
    expect([...actual.data.subarray(at, at + 4)]).toEqual([255, 0, 0, 255]);
    expect([...reference.data.subarray(at, at + 4)]).toEqual([0, 0, 0, 255]);
    expect(error.data[at]).toBeGreaterThan(200);
  });
});

test('a picture is judged by its shares of pixels beyond 1 and beyond 8 steps, too', () => {
  const judged = picture(10, 6, []);
  // Steps of the first four pixels.
  for (const [pixel, steps] of [1, 2, 8, 9].entries()) judged.image.data[4 * pixel] = steps / 255;
  const { beyond1, beyond8 } = judgePicture(judged, picture(10, 6, []));
  expect(60 * beyond1).toBeCloseTo(3, 9);
  expect(60 * beyond8).toBeCloseTo(1, 9);
});
