import { describe, expect, test } from 'vitest';
import { CROP_PX, judgePicture, worstPlace } from './worst-crop.ts';

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
