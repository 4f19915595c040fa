import { describe, expect, test } from 'vitest';
import { type Camera, orthographicCamera, perspectiveCamera } from '../data/camera/camera.ts';
import { randomSplats, type SplatValues, splatsOf } from '../testing/random-splats.ts';
import { renderReference, renderReferenceInTurns } from './render.ts';

/** One pixel per unit, the middle of pixel (4, 4) at the origin: 9 × 9 pixels. */
const CAMERA: Camera = orthographicCamera({
  position: [0, 0, 10],
  target: [0, 0, 0],
  aspect: 1,
  height: 9,
  near: 1,
  far: 100,
});
const SIZE = { widthPx: 9, heightPx: 9 };
const C0 = Math.sqrt(1 / (4 * Math.PI));

/** Coefficients of degree 0 for a colour. */
const dc = (...rgb: number[]) => rgb.map((value) => (value - 0.5) / C0);
const logit = (opacity: number) => Math.log(opacity / (1 - opacity));

function pixels(splats: readonly SplatValues[], camera = CAMERA, settings = {}) {
  const { data, visibleSplats } = renderReference({
    clouds: [{ set: splatsOf(splats) }],
    camera,
    ...SIZE,
    settings,
  });
  const at = (column: number, row: number) =>
    Array.from(data.subarray(4 * (9 * row + column), 4 * (9 * row + column) + 4));
  return { at, visibleSplats, data };
}

const near = (values: readonly number[], digits = 6) => values.map((v) => expect.closeTo(v, digits));

describe('the reference renderer', () => {
  test('one splat: its opacity at its centre, the Gaussian around it, nothing beyond the cutoff', () => {
    // Standard deviation 1 px, so the variance with dilation is 1.3 px².
    const splat = { logScales: [0, 0, 0], opacityLogit: logit(0.6), colorDc: dc(0.2, 0.5, 0.9) };
    const { at, visibleSplats } = pixels([splat]);
    expect(visibleSplats).toBe(1);
    const expected = (distance2: number) => {
      const alpha = 0.6 * Math.exp(-distance2 / 2 / 1.3);
      return near([0.2 * alpha, 0.5 * alpha, 0.9 * alpha, alpha]);
    };
    expect(at(4, 4)).toEqual(expected(0));
    expect(at(5, 4)).toEqual(expected(1));
    expect(at(4, 2)).toEqual(expected(4));
    expect(at(6, 6)).toEqual(expected(8));
    // 0.6·exp(−16/2.6) = 0.0013 is below 1/255.
    expect(at(8, 4)).toEqual([0, 0, 0, 0]);
    expect(pixels([splat], CAMERA, { alphaCutoff: 1e-3 }).at(8, 4)).toEqual(expected(16));
    expect(pixels([splat], CAMERA, { dilationPx2: 0 }).at(5, 4)[3]).toBeCloseTo(0.6 * Math.exp(-0.5), 6);
  });

  test('x is to the right and y up', () => {
    const { at } = pixels([{ position: [2, 3, 0], logScales: [-3, -3, -3], opacityLogit: logit(0.5) }]);
    expect(at(6, 1)[3]).toBeCloseTo(0.5, 6);
    expect(at(2, 7)[3]).toBe(0);
  });

  test('no fragment is more opaque than 0.99', () => {
    expect(pixels([{ logScales: [1, 1, 1] }]).at(4, 4)[3]).toBeCloseTo(0.99, 12);
  });

  test('two splats: the nearer one over the farther one, in any storage order', () => {
    const red = { position: [0, 0, 1], opacityLogit: logit(0.5), colorDc: dc(1, 0, 0) };
    const blue = { position: [0, 0, -1], opacityLogit: logit(0.8), colorDc: dc(0, 0, 1) };
    for (const splats of [
      [red, blue],
      [blue, red],
    ]) {
      expect(pixels(splats).at(4, 4)).toEqual(near([0.5, 0, 0.5 * 0.8, 0.5 + 0.5 * 0.8]));
    }
  });

  test('depths: the mean, and the one that makes a pixel more than half covered, times the opacity', () => {
    const at = (depth: number, opacity: number) => ({
      position: [0, 0, 10 - depth],
      opacityLogit: logit(opacity),
    });
    const depthsOf = (splats: readonly SplatValues[], host = Number.POSITIVE_INFINITY) => {
      const hostDepths = new Float64Array(81).fill(host);
      const clouds = [{ set: splatsOf(splats) }];
      const { data, depths, medianDepths } = renderReference({ clouds, camera: CAMERA, ...SIZE, hostDepths });
      return [data[4 * 40 + 3], depths![40], medianDepths![40]];
    };
    const splats = [at(2, 0.2), at(5, 0.9), at(90, 0.5)];
    const covered = 1 - 0.8 * 0.1 * 0.5;
    const mean = 0.2 * 2 + 0.8 * 0.9 * 5 + 0.8 * 0.1 * 0.5 * 90;
    expect(depthsOf(splats)).toEqual(near([covered, mean, 5 * covered]));
    // The host hides the splat of the median: the last one is it, which covers less than half.
    expect(depthsOf(splats, 4)).toEqual(near([0.2, 0.2 * 2, 0.2 * 2]));
  });

  test('equal depths: the splat stored first is behind, clouds in the order given', () => {
    const red = { opacityLogit: logit(0.5), colorDc: dc(1, 0, 0) };
    const blue = { opacityLogit: logit(0.8), colorDc: dc(0, 0, 1) };
    // Equal Morton codes keep the order of the file.
    expect(pixels([red, blue]).at(4, 4)).toEqual(near([0.5 * 0.2, 0, 0.8, 0.9]));
    expect(pixels([blue, red]).at(4, 4)).toEqual(near([0.5, 0, 0.8 * 0.5, 0.9]));
    const clouds = [{ set: splatsOf([blue]) }, { set: splatsOf([red]) }];
    const { data } = renderReference({ clouds, camera: CAMERA, ...SIZE });
    expect(Array.from(data.subarray(4 * 40, 4 * 41))).toEqual(near([0.5, 0, 0.4, 0.9]));
  });

  test('near and far: the centre decides', () => {
    const at = (depth: number) =>
      pixels([{ position: [0, 0, 10 - depth], logScales: [2, 2, 2] }]).visibleSplats;
    expect([0.5, 1, 1.5, 100, 100.5].map(at)).toEqual([0, 0, 1, 1, 0]);
  });

  test('does not draw splats that are too faint, or whose whole extent is out of sight', () => {
    const count = (splat: SplatValues) => pixels([splat]).visibleSplats;
    expect(count({ opacityLogit: logit(1 / 256) })).toBe(0);
    expect(count({ opacityLogit: logit(1 / 254) })).toBe(1);
    expect(count({ opacityLogit: Number.NEGATIVE_INFINITY })).toBe(0);
    // Opacity 1 reaches √(2·ln 255) = 3.33 standard deviations, here of √1.3 px: 3.80 px.
    expect(count({ position: [4.5 + 3.7, 0, 0], logScales: [0, 0, 0] })).toBe(1);
    expect(count({ position: [4.5 + 3.9, 0, 0], logScales: [0, 0, 0] })).toBe(0);
    expect(count({ position: [0, -4.5 - 3.7, 0], logScales: [0, 0, 0] })).toBe(1);
    expect(count({ position: [0, -4.5 - 3.9, 0], logScales: [0, 0, 0] })).toBe(0);
  });

  test('perspective: sizes fall with depth', () => {
    const camera = perspectiveCamera({ position: [0, 0, 10], target: [0, 0, 0], fovYDegrees: 90, aspect: 1 });
    const splat = { logScales: [0, 0, 0], opacityLogit: logit(0.5) };
    // 4.5 px per unit at depth 1: 0.45 px at depth 10.
    const variance = 0.45 ** 2 + 0.3;
    expect(pixels([splat], camera).at(5, 4)[3]).toBeCloseTo(0.5 * Math.exp(-0.5 / variance), 6);
  });

  test('a model matrix moves, turns and scales', () => {
    const splat = { position: [1, 0, 0], logScales: [Math.log(2), -9, -9], opacityLogit: logit(0.5) };
    // A quarter turn about z, half the size, and one up.
    const modelMatrix = [0, 0.5, 0, 0, -0.5, 0, 0, 0, 0, 0, 0.5, 0, 0, 1, 0, 1];
    const clouds = [{ set: splatsOf([splat]), modelMatrix }];
    const { data } = renderReference({ clouds, camera: CAMERA, ...SIZE });
    const alphaAt = (column: number, row: number) => data[4 * (9 * row + column) + 3];
    // Its centre is now at (0, 1.5), its long axis, one pixel long, points up.
    expect(alphaAt(4, 2)).toBeCloseTo(0.5 * Math.exp(-(0.5 ** 2) / 2 / 1.3), 6);
    expect(alphaAt(4, 3)).toBeCloseTo(0.5 * Math.exp(-(0.5 ** 2) / 2 / 1.3), 6);
    expect(alphaAt(5, 2)).toBeCloseTo(0.5 * Math.exp(-(0.5 ** 2) / 2 / 1.3 - 1 / 2 / 0.3), 6);
  });

  test('a cloud’s opacity multiplies those of its splats, before the cutoff and the cap', () => {
    const splat = { logScales: [1, 1, 1], opacityLogit: logit(0.8) };
    const render = (opacity?: number) =>
      renderReference({ clouds: [{ set: splatsOf([splat]), opacity }], camera: CAMERA, ...SIZE });
    const alpha = (opacity?: number) => render(opacity).data[4 * 40 + 3];
    expect(alpha()).toBeCloseTo(0.8, 6);
    expect(alpha(1)).toBe(alpha());
    expect(alpha(0.5)).toBe(alpha() / 2);
    expect(render(0.0049).visibleSplats).toBe(0);
    expect(render(0.005).visibleSplats).toBe(1);
    expect(render(0).visibleSplats).toBe(0);
  });

  test('no splats give an empty image', () => {
    const { data, visibleSplats } = renderReference({ clouds: [], camera: CAMERA, ...SIZE });
    expect(visibleSplats).toBe(0);
    expect(data.every((value) => value === 0)).toBe(true);
  });
});

describe('the reference renderer in turns', () => {
  const frame = { clouds: [{ set: randomSplats({ count: 5000, shDegree: 1 }) }], camera: CAMERA, ...SIZE };

  test('draws the same image, and tells how much is done, up to all of it', async () => {
    const told: number[] = [];
    const image = await renderReferenceInTurns(frame, { onProgress: (fraction) => told.push(fraction) });
    expect(image).toEqual(renderReference(frame));
    expect(told.length).toBeGreaterThan(8);
    expect(told).toEqual(told.toSorted((a, b) => a - b));
    expect(told[0]).toBeGreaterThanOrEqual(0);
    expect(told.at(-1)).toBeLessThanOrEqual(1);
  });

  test('ends with the reason of its signal, wherever it is', async () => {
    for (const from of [0, 0.2, 0.7]) {
      const ending = new AbortController();
      const reason = new Error(`at ${from}`);
      const onProgress = (fraction: number) => {
        if (fraction >= from) ending.abort(reason);
      };
      await expect(renderReferenceInTurns(frame, { signal: ending.signal, onProgress })).rejects.toBe(reason);
    }
  });
});

test('of equal depths, the last of the file is drawn last; of few splats and of many', () => {
  // Many splats are sorted by larger digits.
  for (const count of [3, 33_000]) {
    const colors = [dc(1, 0, 0), dc(0, 1, 0), dc(0, 0, 1)];
    const splats = Array.from({ length: count }, (_, i) => ({
      position: [0, 0, -((i * 7) % 5)],
      logScales: [-9, -9, -9],
      opacityLogit: logit(0.9),
      colorDc: colors[i % 3],
    }));
    // Of those that are equal in depth and place, the last of the file is drawn last.
    const nearest = splats.findLastIndex(({ position }) => position[2] === 0);
    const [red, green, blue] = pixels(splats).at(4, 4);
    expect([red, green, blue].indexOf(Math.max(red, green, blue))).toBe(nearest % 3);
  }
});
