import { afterEach, describe, expect, test, vi } from 'vitest';
import { renderReference } from '../../reference/render.ts';
import { expectInvalid } from '../../testing/edited-splats.ts';
import { type DrawableImage, FakeCanvas } from '../../testing/fake-canvas.ts';
import { orthographicCamera } from '../camera/camera.ts';
import { SplatSourceError, WebSplatterError } from '../errors.ts';
import { colorOf, opacityOf } from '../splats/color-values.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { type ImagePixels, type SplatImage, splatsFromImage } from './splats-from-image.ts';

afterEach(() => void vi.unstubAllGlobals());

type Pixel = readonly [r: number, g: number, b: number, alpha: number];

function imageOf(width: number, height: number, pixelAt: (x: number, y: number) => Pixel): ImagePixels {
  const pixels = Array.from({ length: width * height }, (_, i) => pixelAt(i % width, Math.floor(i / width)));
  return { width, height, data: Uint8ClampedArray.from(pixels.flat()) };
}

/** Every pixel has a colour and an opacity of its own, 64 and more. */
const MIXED = imageOf(5, 4, (x, y) => [51 * x, 85 * y, 17 * (3 * x + y), 255 - 10 * (x + 4 * y)]);

/** Each pixel of a picture from the front: r, g, b without opacity, and opacity, 0…1. */
function seenFromFront(set: SplatSet, { width, height }: ImagePixels, magnification: number) {
  const [widthPx, heightPx] = [width * magnification, height * magnification];
  const aspect = width / height;
  const camera = orthographicCamera({
    position: [0, 0, 2],
    target: [0, 0, 0],
    aspect,
    height: 1,
    near: 1,
    far: 3,
  });
  const { data } = renderReference({ clouds: [{ set }], camera, widthPx, heightPx });
  return (x: number, y: number) => {
    const middle = (magnification - 1) / 2;
    const at = 4 * (widthPx * (y * magnification + middle) + x * magnification + middle);
    const alpha = data[at + 3];
    return [data[at] / alpha, data[at + 1] / alpha, data[at + 2] / alpha, alpha];
  };
}

describe('splats from an image', () => {
  test('are one flat splat for each pixel, upright and centred, with its colour and alpha', () => {
    const set = splatsFromImage(MIXED, { pixelSize: 0.5 });
    expect(set.count).toBe(20);
    expect(set.harmonics.degree).toBe(0);
    for (let i = 0; i < 20; i++) {
      const [x, y] = [i % 5, Math.floor(i / 5)];
      const place = [0, 1, 2].map((axis) => set.positions[3 * i + axis] + set.origin[axis]);
      expect(place).toEqual([0.5 * (x - 2), 0.5 * (1.5 - y), 0]);
      for (let k = 0; k < 3; k++)
        expect(colorOf(set.colorDc[3 * i + k])).toBeCloseTo(MIXED.data[4 * i + k] / 255, 7);
      expect(opacityOf(set.opacityLogits[i])).toBeCloseTo(MIXED.data[4 * i + 3] / 255, 7);
      const scales = Array.from(set.logScales.subarray(3 * i, 3 * i + 3), Math.exp);
      expect(scales[0]).toBeCloseTo(0.25, 6);
      expect(scales[1]).toBeCloseTo(0.25, 6);
      expect(scales[2]).toBeLessThan(0.001);
    }
  });

  test('come back in float64 as the image: colours and opacities to 1e-7, up to 0.99', () => {
    const at = seenFromFront(splatsFromImage(MIXED, { spread: 0.15 }), MIXED, 21);
    for (let y = 0; y < 4; y++)
      for (let x = 0; x < 5; x++) {
        const [r, g, b, alpha] = Array.from(MIXED.data.subarray(4 * (5 * y + x)), (byte) => byte / 255);
        const seen = at(x, y);
        for (const [k, value] of [r, g, b, Math.min(alpha, 0.99)].entries())
          expect(Math.abs(seen[k] - value), `channel ${k} of ${x}, ${y}`).toBeLessThan(1e-7);
      }
  });

  test('come back by default within the difference of neighbours, and leave no gaps', () => {
    const slow = imageOf(24, 16, (x, y) => [8 * x, 12 * y, 4 * (x + y), 255]);
    const at = seenFromFront(splatsFromImage(slow), slow, 1);
    for (let y = 0; y < 16; y++)
      for (let x = 0; x < 24; x++) {
        const [r, g, b, alpha] = at(x, y);
        expect(Math.abs(r - (8 * x) / 255)).toBeLessThan(8 / 255);
        expect(Math.abs(g - (12 * y) / 255)).toBeLessThan(12 / 255);
        expect(Math.abs(b - (4 * (x + y)) / 255)).toBeLessThan(8 / 255);
        expect(alpha).toBeGreaterThan(0.99);
      }
  });

  test('stand for squares of stepPx with their mean, also where these overlap the edge', () => {
    const image = imageOf(3, 2, (x, y) => (x === 0 ? [255, 0, 0, 255] : [0, 0, 255, y === 0 ? 51 : 0]));
    const set = splatsFromImage(image, { stepPx: 2, pixelSize: 1 });
    expect(set.count).toBe(2);
    const x = (i: number) => set.positions[3 * i] + set.origin[0];
    expect([x(0), x(1)]).toEqual([-0.5, 1.5]);
    expect(Math.exp(set.logScales[0])).toBeCloseTo(1, 6);
    expect(opacityOf(set.opacityLogits[0])).toBeCloseTo((2 * 255 + 51) / (4 * 255), 6);
    expect(opacityOf(set.opacityLogits[1])).toBeCloseTo(51 / (2 * 255), 6);
    expect(colorOf(set.colorDc[0])).toBeCloseTo((2 * 255) / (2 * 255 + 51), 6);
    expect(colorOf(set.colorDc[2])).toBeCloseTo(51 / (2 * 255 + 51), 6);
    expect(colorOf(set.colorDc[5])).toBeCloseTo(1, 6);
  });

  test('have no rows for transparent pixels, and are 1 unit high by default', () => {
    const image = imageOf(2, 10, (x, y) => [9, 9, 9, x === y ? 255 : 0]);
    const set = splatsFromImage(image);
    expect(set.count).toBe(2);
    expect([...set.fileIndices]).toEqual([0, 1]);
    expect(set.positions[1] - set.positions[4]).toBeCloseTo(0.1, 6);
    expect(splatsFromImage(imageOf(2, 2, () => [0, 0, 0, 0])).count).toBe(0);
  });

  test('come from whatever a canvas draws', () => {
    vi.stubGlobal('OffscreenCanvas', FakeCanvas);
    const drawn: DrawableImage = { width: 5, height: 4, pixels: MIXED.data as Uint8ClampedArray };
    expect(splatsFromImage(drawn as never)).toEqual(splatsFromImage(MIXED));
    const element = { naturalWidth: 5, naturalHeight: 4, width: 50, height: 40, pixels: drawn.pixels };
    expect(splatsFromImage(element as never)).toEqual(splatsFromImage(MIXED));
  });

  test('are refused by name', () => {
    for (const pixelSize of [0, -1, Number.NaN, Number.POSITIVE_INFINITY, 1e300, '1'])
      expectInvalid('pixelSize', () => splatsFromImage(MIXED, { pixelSize: pixelSize as number }));
    expectInvalid('spread', () => splatsFromImage(MIXED, { spread: 0 }));
    expectInvalid('options', () => splatsFromImage(MIXED, null as never));
    for (const stepPx of [0, 1.5, -2]) expectInvalid('stepPx', () => splatsFromImage(MIXED, { stepPx }));
    const wrong: unknown[] = [
      null,
      undefined,
      'a.png',
      {},
      { width: 0, height: 0 },
      { naturalWidth: 0, naturalHeight: 0, width: 5, height: 5 },
      { width: 2, height: 2, data: new Uint8Array(15) },
      { width: 1.5, height: 2, data: new Uint8Array(12) },
      { width: 2, height: 2, data: new Float32Array(16) },
      { ...MIXED, colorSpace: 'display-p3' },
    ];
    for (const image of wrong) expectInvalid('image', () => splatsFromImage(image as SplatImage));
  });

  test('are refused if they are too many, with a step that is enough', () => {
    const [width, height] = [4096, 4096];
    const image = { width, height, data: new Uint8ClampedArray(4 * width * height) };
    expect(() => splatsFromImage(image)).toThrow(/16777216 splats .* a stepPx of 2 or more/);
    expect(splatsFromImage(image, { stepPx: 2 }).count).toBe(0);
  });

  test('are refused without a canvas, and if pixels may not be read', () => {
    const image = { width: 2, height: 2 } as ImageBitmap;
    expect(() => splatsFromImage(image)).toThrow(WebSplatterError);
    expect(() => splatsFromImage(image)).toThrow(expect.objectContaining({ code: 'canvas-unavailable' }));
    const tainted = class extends FakeCanvas {
      override getContext() {
        const getImageData = () => {
          throw new DOMException('The canvas has been tainted by cross-origin data.', 'SecurityError');
        };
        return { ...super.getContext(), drawImage() {}, getImageData };
      }
    };
    vi.stubGlobal('OffscreenCanvas', tainted);
    expect(() => splatsFromImage(image)).toThrow(SplatSourceError);
    expect(() => splatsFromImage(image)).toThrow("crossOrigin = 'anonymous'");
  });
});
