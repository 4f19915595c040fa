import { encodePly, perspectiveCamera, readSplats, type SplatSet } from '@websplatter/core';
import { colorDcOf } from '@websplatter/core/own-data';
import { cropSplats } from '@websplatter/core/write';
import { describe, expect, it } from 'vitest';
import type { Crop } from '../state/inspecting.ts';
import { countOf } from '../state/selecting.ts';
import { rowsWithin } from './rows-within.ts';
import {
  boundsInImage,
  histogramsOf,
  markColor,
  type ReadCloud,
  sampledCenters,
  splatInRow,
} from './scene-answers.ts';

const ORIGIN = [10, 0, 0] as const;

/** Splats at `positions` about an origin off zero, the first in row 3, with growing scales. */
function setOf(positions: readonly (readonly [number, number, number])[]): SplatSet {
  const count = positions.length;
  return {
    count,
    origin: ORIGIN,
    positions: Float32Array.from(positions.flat()),
    logScales: Float32Array.from(
      { length: 3 * count },
      (_, i) => Math.log(10 ** Math.floor(i / 3)) + (i % 3),
    ),
    rotations: Float32Array.from({ length: 4 * count }, (_, i) => i),
    opacityLogits: Float32Array.from({ length: count }, (_, i) => (i === 0 ? -Infinity : 3)),
    colorDc: Float32Array.from({ length: 3 * count }, (_, i) => i),
    harmonics: { degree: 1, coefficients: Float32Array.from({ length: 9 * count }, (_, i) => i) },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i + 3),
    dropped: {},
  };
}

const three = setOf([
  [-10, 0, 0],
  [-9, 2, 0],
  [-8, 0, -50],
]);
const clouds = [{ set: three, modelMatrix: null }];
const SHIFTED = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 7, 0, 1];

describe('a splat by its row', () => {
  it('comes alone, with all of its values', () => {
    const splat = splatInRow(clouds[0], 4);
    expect(splat).toMatchObject({ count: 1, origin: ORIGIN, dropped: {} });
    expect([...splat!.positions]).toEqual([-9, 2, 0]);
    expect([...splat!.rotations]).toEqual([4, 5, 6, 7]);
    expect([...splat!.colorDc]).toEqual([3, 4, 5]);
    expect([...splat!.harmonics.coefficients]).toEqual([9, 10, 11, 12, 13, 14, 15, 16, 17]);
    expect([...splat!.fileIndices]).toEqual([4]);
  });

  it('comes from packed harmonics too', async () => {
    const read = await readSplats(encodePly(three), { shPrecision: 'f32' });
    const splat = splatInRow({ set: read, modelMatrix: null }, 2);
    expect([...splat!.harmonics.coefficients]).toEqual([18, 19, 20, 21, 22, 23, 24, 25, 26]);
  });

  it('is none where the row was dropped or is beyond the file', () => {
    expect(splatInRow(clouds[0], 0)).toBeNull();
    expect(splatInRow(clouds[0], 6)).toBeNull();
  });
});

describe('a sample of some rows', () => {
  const placed = [clouds[0], { set: three, modelMatrix: SHIFTED }];
  const rows = [Uint32Array.of(0b101000), Uint32Array.of(0b010000)];

  it('has their centres in the scene, of each file', () => {
    expect(sampledCenters(placed, rows, 10)).toEqual([
      [0, 0, 0],
      [2, 0, -50],
      [1, 9, 0],
    ]);
    expect(sampledCenters(placed, [null, rows[1]], 10)).toEqual([[1, 9, 0]]);
  });

  it('is taken evenly where there are more', () => {
    expect(sampledCenters(placed, rows, 2)).toEqual([
      [0, 0, 0],
      [2, 0, -50],
    ]);
    expect(sampledCenters(placed, rows, 0)).toEqual([]);
  });
});

describe('histograms', () => {
  it('count every splat of every cloud once', () => {
    const twice = [...clouds, { set: setOf([[0, 0, 0]]), modelMatrix: SHIFTED }];
    const histograms = histogramsOf(twice);
    for (const { counts, edges } of Object.values(histograms)) {
      expect(counts.reduce((sum, count) => sum + count, 0)).toBe(4);
      expect(edges).toHaveLength(counts.length + 1);
    }
    expect(histograms.opacity.counts[0]).toBe(2);
    const { edges, counts } = histograms.longest;
    expect(counts.at(-1)).toBe(1);
    expect(edges.at(-1)).toBeGreaterThan(100 * Math.exp(2));
  });
});

describe('a crop', () => {
  const kept = (from: readonly ReadCloud[], crop: Crop) => {
    const masks = rowsWithin(from, { kind: 'all' }, crop, () => histogramsOf(from));
    return countOf(new Map(masks.map((words, i) => [String(i), words])));
  };

  it('counts what cropSplats keeps, inside and outside', () => {
    for (const keep of ['inside', 'outside'] as const) {
      const crop = { min: [0, 0, -50], max: [1, 2, 0], keep } as const;
      expect(kept(clouds, crop)).toBe(cropSplats(three, crop).count);
    }
  });

  it('counts clouds where they stand', () => {
    const shifted = [{ set: three, modelMatrix: SHIFTED }];
    expect(kept(shifted, { min: [0, 7, 0], max: [1, 9, 0], keep: 'inside' })).toBe(2);
  });
});

describe('the colour of marks', () => {
  const setInColors = (...colors: (readonly [number, number, number])[]) => {
    const set = setOf(colors);
    return {
      ...set,
      opacityLogits: set.opacityLogits.fill(3),
      colorDc: Float32Array.from(colors.flat(), colorDcOf),
    };
  };
  const colorFor = (...colors: (readonly [number, number, number])[]) =>
    markColor([{ set: setInColors(...colors), modelMatrix: null }]);
  const [ORANGE, MAGENTA, CYAN, GREEN] = [
    [1, 0.5, 0.1],
    [0.8, 0.2, 0.7],
    [0.1, 0.7, 0.8],
    [0.2, 0.7, 0.1],
  ] as const;

  it('has a hue that is not in the scene', () => {
    const usual = colorFor(ORANGE);
    expect(usual).toEqual(colorFor([0.5, 0.5, 0.5]));
    expect(usual[0] - usual[1]).toBeGreaterThan(0.5);
    expect(usual[2] - usual[1]).toBeGreaterThan(0.5);
    const onMagenta = colorFor(MAGENTA, ORANGE);
    expect(onMagenta[1] - onMagenta[0]).toBeGreaterThan(0.5);
  });

  it('has the rarest hue of a scene of all hues', () => {
    const [red, green, blue] = colorFor(MAGENTA, MAGENTA, CYAN, CYAN, ORANGE, ORANGE, GREEN);
    expect([green > red, green > blue]).toEqual([true, true]);
  });
});

describe('the box around what is seen', () => {
  const { viewMatrix, projectionMatrix } = perspectiveCamera({
    position: [0.5, 1, 9],
    target: [0.5, 1, 0],
    aspect: 1,
    fovYDegrees: 30,
  });
  const look = {
    viewMatrix: Array.from(viewMatrix),
    projectionMatrix: Array.from(projectionMatrix),
    isFlipped: false,
  };

  it('has the centres within the image, however deep', () => {
    expect(boundsInImage(clouds, look)).toEqual({ min: [0, 0, -50], max: [2, 2, 0] });
    const near = [...look.viewMatrix];
    near[14] += 20;
    // Two are behind the camera.
    expect(boundsInImage(clouds, { ...look, viewMatrix: near })).toEqual({
      min: [2, 0, -50],
      max: [2, 0, -50],
    });
  });

  it('follows the way up that the scene is shown, in the scene’s own space', () => {
    expect(boundsInImage(clouds, { ...look, isFlipped: true })).toEqual({ min: [0, 0, 0], max: [0, 0, 0] });
    const away = [...look.viewMatrix];
    away[14] = 500;
    expect(boundsInImage(clouds, { ...look, viewMatrix: away })).toBeNull();
  });
});
