import { type Camera, orthographicCamera, perspectiveCamera } from '@websplatter/core';
import { renderReference } from '@websplatter/core/reference';
import { describe, expect, it } from 'vitest';
import { drawnSize, pictureTiles, tileCamera } from './pictures.ts';

const WIDTH_PX = 72;
const HEIGHT_PX = 50;
const SMALL_TILES = { mostPixels: 100, tilePx: 32, marginPx: 2 };

describe('tiles of a picture', () => {
  it('are one, without a margin, where the picture can be drawn at once', () => {
    expect(pictureTiles(3840, 2160)).toEqual([
      [{ xPx: 0, yPx: 0, widthPx: 3840, heightPx: 2160, marginPx: 0 }],
    ]);
    expect(pictureTiles(9000, 10)[0]).toHaveLength(5);
  });

  it('cover each pixel once', () => {
    const covered = new Uint8Array(WIDTH_PX * HEIGHT_PX);
    for (const { xPx, yPx, widthPx, heightPx } of pictureTiles(WIDTH_PX, HEIGHT_PX, SMALL_TILES).flat())
      for (let y = yPx; y < yPx + heightPx; y++)
        for (let x = xPx; x < xPx + widthPx; x++) covered[y * WIDTH_PX + x]++;
    expect(covered.every((count) => count === 1)).toBe(true);
  });

  it('keep the camera itself where there is one', () => {
    const camera = orthographicCamera({ position: [0, 0, 1], target: [0, 0, 0], aspect: 1, height: 1 });
    expect(tileCamera(camera, 8, 8, pictureTiles(8, 8)[0][0])).toBe(camera);
  });

  const from = { position: [0.6, 0.7, 1.6], target: [0, 0.1, 0], aspect: WIDTH_PX / HEIGHT_PX } as const;
  it.each<[string, Camera, number]>([
    ['orthographic', orthographicCamera({ ...from, height: 1.2 }), 1e-9],
    ['perspective', perspectiveCamera({ ...from, fovYDegrees: 50 }), 1e-9],
  ])('join into the picture that one drawing shows, of an %s camera', (_, camera, tolerance) => {
    const clouds = [{ set: largeAndSmall() }];
    const whole = renderReference({ clouds, camera, widthPx: WIDTH_PX, heightPx: HEIGHT_PX }).data;
    expect(whole.some((value) => value > 0.2)).toBe(true);
    let largest = 0;
    for (const tile of pictureTiles(WIDTH_PX, HEIGHT_PX, SMALL_TILES).flat()) {
      const [widthPx, heightPx] = drawnSize(tile);
      const part = renderReference({
        clouds,
        camera: tileCamera(camera, WIDTH_PX, HEIGHT_PX, tile),
        widthPx,
        heightPx,
      }).data;
      for (let y = 0; y < tile.heightPx; y++)
        for (let i = 0; i < 4 * tile.widthPx; i++) {
          const at = 4 * ((y + tile.marginPx) * widthPx + tile.marginPx) + i;
          const expected = whole[4 * ((tile.yPx + y) * WIDTH_PX + tile.xPx) + i];
          largest = Math.max(largest, Math.abs(part[at] - expected));
        }
    }
    expect(largest).toBeLessThan(tolerance);
  });
});

/** Splats in a cube, of which every tenth reaches across tiles. */
function largeAndSmall() {
  const count = 300;
  const spread = (i: number, factor: number) => ((i * factor) % 1) - 0.5;
  const positions = Float32Array.from({ length: 3 * count }, (_, i) =>
    spread(i / 3 + 1, [0.618034, 0.754878, 0.569841][i % 3]),
  );
  return {
    count,
    origin: [0, 0, 0] as const,
    positions,
    logScales: Float32Array.from({ length: 3 * count }, (_, i) => Math.log(i % 30 < 3 ? 0.3 : 0.03)),
    rotations: Float32Array.from({ length: 4 * count }, (_, i) => (i % 4 === 0 ? 1 : 0)),
    opacityLogits: new Float32Array(count).fill(-1),
    colorDc: Float32Array.from({ length: 3 * count }, (_, i) => spread(i, 0.37)),
    harmonics: { degree: 0 as const, coefficients: new Float32Array(0) },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
    dropped: {},
  };
}
