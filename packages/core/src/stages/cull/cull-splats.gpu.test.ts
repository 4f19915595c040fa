import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { DILATION_PX2 } from '../../data/accuracy/accuracy.ts';
import { orthographicCamera, projectionOf } from '../../data/camera/camera.ts';
import { cloudView } from '../../data/camera/cloud-view.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { Page, View } from '../../data/layout/structs.ts';
import { identity4 } from '../../data/math/mat4.ts';
import { packGeometry } from '../../data/packing/geometry.ts';
import { compareCulling } from '../../inspect/compare-culling.ts';
import { InspectedFrame, type InspectOptions } from '../../inspect/inspected-frame.ts';
import type { SplatValues } from '../../reference/effects/effect-reference.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { MERGED_OPACITIES } from '../../testing/tile-buffers.ts';
import { cullSplat } from './cull.reference.ts';
import { cullSplats } from './cull.ts';

const gpu = testGpu();

const SIZE = { widthPx: 48, heightPx: 32 };
const SPLATS = 800;
const isFull = process.env.WEBSPLATTER_FULL === '1';

/**
 * Draws a frame by the shaders for few and for many threads in lockstep, checks which splats the
 * first drew, and that the second drew the same; counts the drawn ones and those left to rounding.
 */
async function check(options: Omit<InspectOptions, 'widthPx' | 'heightPx' | 'keyBits'>) {
  const draw = (isNarrow: boolean) =>
    InspectedFrame.draw(gpu.device, { ...options, ...SIZE, keyBits: 8, isNarrow });
  const [narrow, wide] = [await draw(true), await draw(false)];
  const { visibleCount, unsureCount, mismatches, flaws } = await compareCulling(narrow);
  expect(flaws).toEqual([]);
  expect(mismatches.length, `first: ${JSON.stringify(mismatches[0])}`).toBe(0);
  const [first, second] = [await drawnBy(narrow), await drawnBy(wide)];
  expect(second).toEqual(first);
  for (const frame of [narrow, wide]) frame.destroy();
  return { visibleCount, unsure: unsureCount };
}

/** All that `compareCulling` looks at in a frame. */
async function drawnBy(frame: InspectedFrame) {
  const visibleSplats = await frame.words('visibleSplats');
  return {
    visibleSplats: visibleSplats.subarray(0, await frame.visibleCount()),
    depthRange: await frame.words('depthRange'),
  };
}

describe('cull-splats', () => {
  for (const [name, camera] of Object.entries(testCameras(1.5))) {
    gpuTest(`${name} camera: draws the splats that the reference draws`, async () => {
      const set = randomSplats({ count: SPLATS, shDegree: 0, seed: 7 });
      const { visibleCount, unsure } = await check({ clouds: [{ set }], camera });
      expect(visibleCount).toBeGreaterThan(SPLATS / 50);
      expect(unsure).toBeLessThan(SPLATS / 100);
    });
  }

  const { sheared, mirrored } = TEST_MODELS;
  for (const [name, modelMatrix] of Object.entries(isFull ? TEST_MODELS : { sheared, mirrored })) {
    gpuTest(`${name} model, packed, two pages, rows of 2 workgroups`, { tags: 'deeper' }, async () => {
      const set = randomSplats({ count: SPLATS, shDegree: 0, seed: 8 });
      const { visibleCount, unsure } = await check({
        clouds: [
          { set, modelMatrix, splatsPerPage: 512 },
          { set: randomSplats({ count: 100, shDegree: 0, seed: 9 }) },
        ],
        camera: testCameras(1.5).perspective,
        accuracy: { geometryPrecision: 'packed' },
        dispatchRow: 2,
      });
      expect(visibleCount).toBeGreaterThan(SPLATS / 50);
      expect(unsure).toBeLessThan(SPLATS / 100);
    });
  }

  gpuTest('the range of distances', async () => {
    for (const name of ['perspective', 'inside'] as const) {
      const clouds = [{ set: randomSplats({ count: SPLATS, shDegree: 0, seed: 7 }) }];
      await check({ clouds, camera: testCameras(1.5)[name], sortBy: 'distance' });
    }
  });

  gpuTest('faint splats, large ones around the eye, and a high cutoff', async () => {
    const camera = testCameras(1.5).inside;
    const faint = randomSplats({ count: SPLATS, shDegree: 0, opacityLogits: [-5.7, -5.4] });
    const large = randomSplats({ count: SPLATS, shDegree: 0, seed: 3, logScales: [-3, 3] });
    for (const alphaCutoff of [1 / 255, 0.05]) {
      const { visibleCount } = await check({
        clouds: [{ set: faint }, { set: large }],
        camera,
        accuracy: { alphaCutoff },
      });
      expect(visibleCount).toBeGreaterThan(SPLATS / 4);
    }
  });

  for (const geometryPrecision of ['f32', 'packed'] as const) {
    gpuTest(`clouds of any opacity, ${geometryPrecision}`, async () => {
      const cloud = (seed: number, opacity: number) => ({
        set: randomSplats({ count: SPLATS, shDegree: 0, seed, logScales: [-4, -1] }),
        opacity,
      });
      const camera = testCameras(1.5).perspective;
      const accuracy = { geometryPrecision };
      const { visibleCount } = await check({ clouds: [cloud(1, 0.5), cloud(2, 0.01)], camera, accuracy });
      const { visibleCount: opaque } = await check({ clouds: [cloud(1, 1), cloud(2, 1)], camera, accuracy });
      expect(visibleCount).toBeGreaterThan(SPLATS / 4);
      expect(visibleCount).toBeLessThan(0.8 * opaque);
      expect((await check({ clouds: [cloud(1, 0)], camera, accuracy })).visibleCount).toBe(0);
    });
  }

  const large = randomSplats({ count: SPLATS, shDegree: 0, seed: 5, logScales: [-5, -1] });
  const chunkFar = {
    set: large,
    modelMatrix: Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 50, 1),
  };
  const optionsOf = (camera: string) => ({
    clouds: [{ set: large }, chunkFar],
    camera: testCameras(1.5)[camera],
  });
  /** Splats drawn with the settings that the others are compared with, by camera. */
  const plain: Record<string, ReturnType<typeof check>> = {};
  const someSettings = [{ extent: 'fixed' }, { culling: 'frustum' }] as const;
  // Under `frustum` no extent is compared: the shader is that of `frustum` alone.
  const both = { extent: 'fixed', culling: 'frustum' } as const;
  const cameras = isFull ? ['inside', 'telephoto', 'orthographic'] : ['inside', 'orthographic'];
  for (const settings of isFull ? [...someSettings, both] : someSettings) {
    gpuTest(
      `${Object.values(settings).join(' extent, ')}: draws more, and the splats that the reference draws`,
      { tags: 'deeper' },
      async () => {
        for (const name of cameras) {
          plain[name] ??= check(optionsOf(name));
          const { visibleCount } = await plain[name];
          const other = await check({ ...optionsOf(name), accuracy: settings });
          expect(other.visibleCount).toBeGreaterThan(visibleCount);
          expect(other.unsure).toBeLessThan(SPLATS / 100);
        }
      },
    );
  }

  gpuTest('merged splats: as far outside of the image as their stacks reach', async () => {
    const camera = orthographicCamera({
      position: [0, 0, 5],
      target: [0, 0, 0],
      aspect: 1.5,
      height: 32,
      far: 10,
    });
    const projection = projectionOf(camera, SIZE.widthPx, SIZE.heightPx);
    const cloud = cloudView(camera.viewMatrix, identity4(), [0, 0, 0], true);
    const set = randomSplats({ count: SPLATS, shDegree: 0, halfExtent: 45, logScales: [-3, 2.5] });
    for (let i = 0; i < SPLATS; i++) set.positions[3 * i + 2] /= 45;
    const opacityOf = (i: number) => MERGED_OPACITIES[i % MERGED_OPACITIES.length];
    const geometry = new Float32Array(packGeometry(set, 'f32').words.buffer);
    for (let i = 0; i < SPLATS; i++) geometry[16 * i + 3] = opacityOf(i);
    const chunkCount = Math.ceil(SPLATS / CHUNK_SPLATS);
    const masks = gpu.storage([], (CHUNK_SPLATS / 8) * chunkCount);
    const alphaCutoff = 1 / 255;
    const bindings = {
      view: gpu.uniform(
        View.pack({ ...projection, alphaCutoff, sizePx: [SIZE.widthPx, SIZE.heightPx], dispatchRow: 99 }),
      ),
      page: gpu.uniform(
        Page.pack({
          ...cloud,
          dilationPx2: DILATION_PX2,
          camera: [0, 0, 0],
          cameraWeight: 0,
          sight: [1, 0, 0, 0, 1, 0, 0, 0, 1],
          cellStart: 0,
          frustum: new Float64Array(24),
          frustumReach: new Float64Array(24),
          index: 0,
          chunkStart: 0,
          chunkCount,
          splatCount: SPLATS,
        }),
      ),
      pagePlans: gpu.storage([0, chunkCount, 0, chunkCount, 0, 0]),
      visibleChunks: gpu.storage(Array.from({ length: chunkCount }, (_, i) => i)),
      geometry: gpu.storage(geometry),
      visibilityMasks: masks,
      splatOffsets: gpu.storage([], 4 * chunkCount),
      depthRange: gpu.storage([], 8),
    };
    const variant = { isOrthographic: true, geometryPrecision: 'f32', culling: 'bounding-box' } as const;
    await gpu.run(cullSplats({ ...variant, extent: 'opacity', isStacked: true }), bindings, [
      chunkCount,
      1,
      1,
    ]);
    const words = await gpu.read(masks);
    /** Whether the reference draws a splat in an image that is wider by `marginPx` on each side. */
    const isDrawn = (i: number, opacity: number, marginPx: number) => {
      const [widthPx, heightPx] = [SIZE.widthPx + 2 * marginPx, SIZE.heightPx + 2 * marginPx];
      const centerPx = [widthPx / 2, heightPx / 2] as const;
      const effects = [{ changeSplat: (splat: SplatValues) => ({ ...splat, opacity }) }];
      return (
        cullSplat(
          set,
          i,
          cloud,
          { ...projection, widthPx, heightPx, centerPx },
          { alphaCutoff, dilationPx2: DILATION_PX2, effects },
        ) !== null
      );
    };
    let [farther, unsure] = [0, 0];
    for (let i = 0; i < SPLATS; i++) {
      const expected = isDrawn(i, opacityOf(i), 0);
      if (isDrawn(i, opacityOf(i), -1e-3) !== isDrawn(i, opacityOf(i), 1e-3)) unsure++;
      else expect(((words[i >> 5] >>> (i % 32)) & 1) === 1, `splat ${i}`).toBe(expected);
      if (expected && !isDrawn(i, 1, 0)) farther++;
    }
    expect(unsure).toBeLessThan(SPLATS / 100);
    expect(farther).toBeGreaterThan(SPLATS / 100);
  });

  gpuTest('no visible splats', async () => {
    const set = randomSplats({ count: 300, shDegree: 0, opacityLogits: [-9, -7] });
    const { visibleCount } = await check({ clouds: [{ set }], camera: testCameras(1.5).perspective });
    expect(visibleCount).toBe(0);
  });
});
