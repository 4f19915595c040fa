import { expect, test } from 'vitest';
import { orthographicCamera, perspectiveCamera } from '../data/camera/camera.ts';
import { randomSplats, splatsOf } from '../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../testing/test-cameras.ts';
import { renderReference } from './render.ts';
import { traceSplat } from './trace-splat.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const camera = perspectiveCamera({ position: [0, 0, 4], target: [0, 0, 0], aspect: 1, fovYDegrees: 60 });

test('the last colour is the one that the reference draws, and the centre is where it draws it', () => {
  const splat = randomSplats({ count: 1, seed: 4, shDegree: 3, logScales: [-3, -2] });
  const opaque = { ...splat, opacityLogits: Float32Array.of(9) };
  let compared = 0;
  for (const [name, each] of Object.entries(testCameras(1))) {
    for (const modelMatrix of [undefined, TEST_MODELS.sheared]) {
      const traced = traceSplat(opaque, 0, { camera: each, ...SIZE, modelMatrix });
      if (!traced) continue;
      const [x, y] = traced.centerPx.map(Math.floor);
      if (!(x >= 0 && x < 64 && y >= 0 && y < 64)) continue;
      const { data } = renderReference({ clouds: [{ set: opaque, modelMatrix }], camera: each, ...SIZE });
      const [red, green, blue, alpha] = data.subarray(4 * (64 * y + x));
      compared++;
      expect(alpha, name).toBeGreaterThan(0.3);
      for (const [channel, value] of [red, green, blue].entries())
        expect(value / alpha, name).toBeCloseTo(traced.colors[3][channel], 9);
    }
  }
  expect(compared).toBeGreaterThan(3);
});

test('colours are listed by degree: the base colour first, seen alike from everywhere', () => {
  const set = randomSplats({ count: 1, seed: 1, shDegree: 2 });
  const behind = perspectiveCamera({ position: [0, 0, -4], target: [0, 0, 0], aspect: 1, fovYDegrees: 60 });
  const [front, back] = [camera, behind].map((each) => traceSplat(set, 0, { camera: each, ...SIZE }));
  expect(front?.colors).toHaveLength(3);
  expect(front?.colors[0]).toEqual(back?.colors[0]);
  expect(front?.colors[2]).not.toEqual(back?.colors[2]);
});

test('the ellipse ends where the opacity reaches the cutoff', () => {
  const parallel = orthographicCamera({ position: [0, 0, 4], target: [0, 0, 0], aspect: 1, height: 64 });
  // One unit is one pixel.
  const set = splatsOf([{ position: [3, 5, 0], logScales: [Math.log(6), Math.log(2), 0], opacityLogit: 0 }]);
  const traced = traceSplat(set, 0, { camera: parallel, ...SIZE, alphaCutoff: 1 / 4 });
  expect(traced?.depthView).toBeCloseTo(4, 12);
  expect(traced?.centerPx).toEqual([35, 27]);
  // 0.5 · exp(−½ r²) = 0.25 at r = √(2 ln 2) standard deviations; the screen adds 0.3 px².
  const reach = Math.sqrt(2 * Math.LN2);
  expect(Math.hypot(...traced!.majorPx)).toBeCloseTo(reach * Math.sqrt(36.3), 6);
  expect(Math.hypot(...traced!.minorPx)).toBeCloseTo(reach * Math.sqrt(4.3), 6);
  expect(traced!.majorPx[1]).toBeCloseTo(0, 9);
});

test('an invisible splat has no trace; one beside the image has', () => {
  const trace = (values: Parameters<typeof splatsOf>[0][number]) =>
    traceSplat(splatsOf([values]), 0, { camera, ...SIZE });
  expect(trace({ position: [0, 0, 5] })).toBeNull();
  expect(trace({ position: [0, 0, 0], opacityLogit: -9 })).toBeNull();
  expect(trace({ position: [50, 0, 0] })?.centerPx[0]).toBeGreaterThan(64);
});
