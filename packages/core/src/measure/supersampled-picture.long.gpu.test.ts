// Proves: pictures with 4×4 samples per pixel are those of float64.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { createEngine, SplatEngine } from '../create-engine.ts';
import { type Camera, orthographicCamera, perspectiveCamera } from '../data/camera/camera.ts';
import { antialias } from '../gpu/effects/antialias/antialias.ts';
import { readTexture } from '../gpu/read-texture.ts';
import { compareImages, renderReference } from '../reference/index.ts';
import { averageSamples } from '../stages/measure/measure.reference.ts';
import { SAMPLES_PER_SIDE } from '../stages/measure/measure.ts';
import { MIN_PSNR_DB } from '../testing/preset-engines.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { testCameras } from '../testing/test-cameras.ts';
import { CROPS, drawSupersampled } from './supersampled-picture.ts';

/** Some reach across crops, and beyond the picture. */
const set = randomSplats({ count: 400, logScales: [-5, -1] });
const effects = [antialias()];
const place = { position: [1.1, 0.6, 1.4], target: [0.1, -0.1, 0] } as const;
const SIZES = [
  { widthPx: 24, heightPx: 16 },
  // Crops of 10×6 px: the last of them have 7 and 3 px of the picture.
  { widthPx: 37, heightPx: 21 },
  // Two crops, then three.
  { widthPx: 2, heightPx: 5 },
];

let device: GPUDevice;
let engine: SplatEngine;
beforeAll(async () => {
  device = await shareTestDevice();
  engine = await SplatEngine.create({ device, accuracy: 'reference' });
});
afterAll(() => engine?.destroy());

type Size = (typeof SIZES)[number];

async function drawn(by: SplatEngine, camera: Camera, size: Size): Promise<Float32Array> {
  const cloud = by.add(set);
  const before = by.memory().totalBytes;
  let crops = 0;
  const frame = { camera, clouds: [{ cloud, effects }], ...size };
  const picture = await drawSupersampled(by, frame, () => crops++);
  expect(crops).toBe(CROPS);
  expect(by.memory().totalBytes - before).toBe(16 * size.widthPx * size.heightPx);
  const { data } = await readTexture(by.device, picture.blended().color!);
  picture.destroy();
  expect(by.memory().totalBytes).toBe(before);
  cloud.destroy();
  return data;
}

function inFloat64(camera: Camera, size: Size): Float64Array {
  const fine = {
    widthPx: SAMPLES_PER_SIDE * size.widthPx,
    heightPx: SAMPLES_PER_SIDE * size.heightPx,
  };
  const { data } = renderReference({ clouds: [{ set, effects }], camera, ...fine });
  return averageSamples(data, size, SAMPLES_PER_SIDE);
}

describe('the supersampled picture', () => {
  for (const size of SIZES) {
    const aspect = size.widthPx / size.heightPx;
    const { perspective, 'off-centre': offCentre, orthographic } = testCameras(aspect);
    const { projectionMatrix } = testCameras(2 * aspect)['off-centre'];
    const part = { ...offCentre, wholeProjectionMatrix: projectionMatrix };
    for (const [name, camera] of Object.entries({ perspective, orthographic, part })) {
      gpuTest(`is that of float64: ${name}, ${size.widthPx}×${size.heightPx} px`, async () => {
        const expected = inFloat64(camera, size);
        expect(Math.max(...expected)).toBeGreaterThan(0.2);
        const found = compareImages(await drawn(engine, camera, size), expected, size);
        expect(found.psnrDb).toBeGreaterThanOrEqual(MIN_PSNR_DB.reference);
      });
    }
  }

  gpuTest('is seen to be wrong if samples are off by one, or not averaged', async () => {
    const [size] = SIZES;
    const camera = perspectiveCamera({ ...place, fovYDegrees: 50, aspect: size.widthPx / size.heightPx });
    const expected = inFloat64(camera, size);
    for (const [find, replace] of [
      ['let first = SAMPLES_PER_SIDE * pixel.xy;', 'let first = SAMPLES_PER_SIDE * pixel.xy + vec2u(1, 0);'],
      ['first + vec2u(x, y)', 'first'],
    ]) {
      const mutation = { file: 'stages/average-samples', find, replace };
      const wrong = await createEngine({ device, accuracy: 'reference' }, { mutation });
      const found = compareImages(await drawn(wrong, camera, size), expected, size);
      expect(found.psnrDb, replace).toBeLessThan(MIN_PSNR_DB.balanced);
      wrong.destroy();
    }
  });

  gpuTest('frees its memory if it is ended', async () => {
    const camera = orthographicCamera({ ...place, height: 2, aspect: 1 });
    const cloud = engine.add(set);
    const before = engine.memory().totalBytes;
    const frame = { camera, clouds: [{ cloud }], widthPx: 16, heightPx: 16 };
    let crops = 0;
    const ending = drawSupersampled(engine, frame, () => {
      if (++crops === 3) throw new Error('enough');
    });
    await expect(ending).rejects.toThrow('enough');
    expect(engine.memory().totalBytes).toBe(before);
    cloud.destroy();
  });
});
