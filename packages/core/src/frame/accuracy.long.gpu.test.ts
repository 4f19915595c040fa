// Proves: each setting of accuracy changes the image as it says, and no more.
import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import { ACCURACY_PRESETS, type AccuracySettings } from '../data/accuracy/accuracy.ts';
import type { ShDegree, SplatSet } from '../data/splats/splat-set.ts';
import { InspectedFrame } from '../inspect/inspected-frame.ts';
import { readRecords } from '../inspect/read-records.ts';
import { compareImages, renderReference } from '../reference/index.ts';
import { rasterizeSplat } from '../stages/quads/quads.reference.ts';
import { randomSplats, splatsOf } from '../testing/random-splats.ts';
import { testCameras } from '../testing/test-cameras.ts';
import { visibleSplatOf } from '../testing/visible-splat.ts';
import type { SplatView } from '../views/splat-view.ts';

/** Images with each setting, against float64 with equal settings. Stages have their own tests. */

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERAS = testCameras(1);
const CAMERA = CAMERAS.perspective;

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
beforeAll(async () => {
  device = await shareBlendingDevice();
  engine = await SplatEngine.create({ device, accuracy: 'reference' });
  view = engine.createView();
});

const NO_REST = splatsOf([]).harmonics;
const SCENE = randomSplats({ count: 1500, seed: 40, logScales: [-4.5, -1.5] });

type Change = Partial<AccuracySettings> & { readonly shDegree?: ShDegree };

async function drawWith(
  settings: Partial<AccuracySettings>,
  set = SCENE,
  camera = CAMERA,
  shDegree?: ShDegree,
) {
  const cloud = engine.add(set);
  try {
    const accuracy = { preset: 'reference', ...settings } as const;
    view.render({ camera, clouds: [{ cloud, shDegree }], ...SIZE, accuracy });
    return (await view.readPixels()).data;
  } finally {
    cloud.destroy();
  }
}

function psnrAgainstReference(
  data: Float32Array,
  settings: Partial<AccuracySettings>,
  set: SplatSet = SCENE,
  camera = CAMERA,
): number {
  const reference = renderReference({ clouds: [{ set }], camera, ...SIZE, settings });
  return compareImages(data, reference.data, SIZE).psnrDb;
}

describe('accuracy settings', () => {
  for (const settings of [
    { extent: 'fixed' },
    { culling: 'frustum' },
    { extent: 'fixed', culling: 'frustum' },
  ] as const) {
    gpuTest(`${JSON.stringify(settings)}: the same image`, async () => {
      const large = randomSplats({ count: 800, seed: 41, logScales: [-4, 1], opacityLogits: [-5, 2] });
      for (const camera of [CAMERA, CAMERAS.inside, CAMERAS.orthographic]) {
        for (const set of [SCENE, large]) {
          const plain = await drawWith({}, set, camera);
          const other = await drawWith(settings, set, camera);
          // Other corners round otherwise; pixels at the cutoff fall either way.
          const { psnrDb, p999Error } = compareImages(other, plain, SIZE);
          expect(psnrDb).toBeGreaterThan(70);
          expect(p999Error).toBeLessThan(1e-3);
          expect(psnrAgainstReference(other, settings, set, camera)).toBeGreaterThan(60);
        }
      }
    });
  }

  gpuTest('sort keys of fewer bits: the image in the order of the shortened keys', async () => {
    // A deep scene, so that few bits lose much.
    const set = randomSplats({ count: 1500, seed: 42, halfExtent: 30, logScales: [-2, 0] });
    const camera = CAMERAS.inside;
    const exact = await drawWith({}, set, camera);
    for (const sortKeyBits of [24, 16] as const) {
      const data = await drawWith({ sortKeyBits }, set, camera);
      // Splats swap if their float32 depths cross a step, which the reference does not model.
      expect(psnrAgainstReference(data, { sortKeyBits }, set, camera), `${sortKeyBits} bits`).toBeGreaterThan(
        55,
      );
      // Depths with equal keys are within 2^-(bits − 4) of each other: the image hardly changes.
      expect(compareImages(data, exact, SIZE).psnrDb).toBeGreaterThan(45);
    }
  });

  gpuTest("the paper's records: drawn with exactly the values that they hold", async () => {
    for (const logScales of [
      [-4.5, -1.5],
      [-9, 1],
    ] as const) {
      const set = randomSplats({ count: 300, seed: 43, shDegree: 0, logScales });
      const accuracy = { recordPrecision: 'paper', colorTarget: engine.accuracy.colorTarget } as const;
      const frame = await InspectedFrame.draw(device, {
        clouds: [{ set }],
        camera: CAMERA,
        ...SIZE,
        accuracy,
      });
      const records = await readRecords(frame);
      const image = { ...SIZE, data: new Float64Array(4 * SIZE.widthPx * SIZE.heightPx) };
      for (const index of await frame.sorted('order')) {
        const [r, g, b] = records[index].color;
        rasterizeSplat(image, visibleSplatOf(records[index]), [r, g, b], 1 / 255);
      }
      expect(compareImages(frame.image.data, image.data, SIZE).psnrDb).toBeGreaterThan(58);
      frame.destroy();
    }
  });

  gpuTest('the records of the paper: close to the image of exact ones', async () => {
    // Those records clamp colours at 1: the scene's stay below.
    const set = { ...SCENE, harmonics: NO_REST, colorDc: SCENE.colorDc.map((value) => value / 2) };
    const data = await drawWith({ recordPrecision: 'paper' }, set);
    expect(psnrAgainstReference(data, {}, set)).toBeGreaterThan(45);
  });

  gpuTest('an 8-bit target: every value a step of it', async () => {
    const data = await drawWith({ colorTarget: 'rgba8unorm' });
    expect(data.every((value) => Math.abs(255 * value - Math.round(255 * value)) < 1e-4)).toBe(true);
    // Each layer rounds by half a step, partly covered by later ones; a single rounding is 58.9 dB.
    expect(psnrAgainstReference(data, {})).toBeGreaterThan(44);
  });

  gpuTest('a scaled resolution: drawn small, enlarged smoothly', async () => {
    for (const resolutionScale of [0.25, 0.5, 0.77]) {
      const settings = { resolutionScale };
      for (const camera of [CAMERA, CAMERAS.orthographic, CAMERAS['off-centre']]) {
        // As exact as at full size, since enlarging averages.
        expect(
          psnrAgainstReference(await drawWith(settings, SCENE, camera), settings, SCENE, camera),
        ).toBeGreaterThan(58);
      }
    }
  });

  gpuTest('a scaled resolution may change every frame, and picks follow the image', async () => {
    const cloud = engine.add(SCENE);
    const frame = { camera: CAMERA, clouds: [{ cloud }], widthPx: 63, heightPx: 41 };
    const own = engine.createView();
    const before = engine.memory().totalBytes;
    let opaque = 0;
    for (const resolutionScale of [1, 0.5, 0.3, 1, 0.3]) {
      own.render({ ...frame, accuracy: { preset: 'reference', resolutionScale } });
      const { data, widthPx, heightPx } = await own.readPixels();
      expect([widthPx, heightPx, data.length]).toEqual([63, 41, 4 * 63 * 41]);
      for (const [xPx, yPx] of [
        [0, 0],
        [62.99, 40.99],
        [31.5, 20.2],
        [10, 35],
      ]) {
        const picked = await own.pick(xPx, yPx);
        const alpha = data[4 * (Math.floor(yPx) * 63 + Math.floor(xPx)) + 3];
        // The image averages pixels of the layer; a pick reads one of them.
        if (resolutionScale === 1) expect(picked?.totalOpacity ?? 0).toBeCloseTo(alpha, 3);
        else if (alpha > 0.9) {
          opaque++;
          expect(picked?.totalOpacity).toBeGreaterThan(0.5);
        }
      }
    }
    expect(opaque).toBeGreaterThan(0);
    own.render({ ...frame, accuracy: 'reference' });
    await own.readPixels();
    own.destroy();
    cloud.destroy();
    expect(engine.memory().totalBytes).toBeLessThan(before);
  });

  gpuTest('settings and degrees that only change a number or a shader need no other buffers', async () => {
    const cloud = engine.add(SCENE);
    const own = engine.createView();
    const frame = { camera: CAMERA, ...SIZE };
    // The room for pairs of tiles follows the frames drawn.
    const QUADS = { rasterizer: 'quads' } as const;
    const buffersMadeFor = async ({ shDegree, ...settings }: Change) => {
      const { createBuffer } = device;
      const made: string[] = [];
      device.createBuffer = (descriptor) => {
        made.push(descriptor.label ?? '');
        return createBuffer.call(device, descriptor);
      };
      try {
        const accuracy = { preset: 'reference', ...QUADS, ...settings } as const;
        own.render({ ...frame, clouds: [{ cloud, shDegree }], accuracy });
        await own.whenDrawn();
      } finally {
        device.createBuffer = createBuffer;
      }
      return made;
    };
    expect(await buffersMadeFor({})).toContain('frame records');
    for (const change of [
      { alphaCutoff: 0.02 },
      { shDegree: 0 },
      { shDegree: 2 },
      { extent: 'fixed' },
      { culling: 'frustum' },
      { colorTarget: 'rgba8unorm' },
    ] as Change[]) {
      expect(await buffersMadeFor(change), JSON.stringify(change)).toEqual([]);
      const { shDegree, ...settings } = change;
      const { buffer } = await drawWith({ ...QUADS, ...settings }, SCENE, CAMERA, shDegree);
      const { data } = await own.readPixels();
      // The image equals that of a view that has never drawn anything else.
      expect(Buffer.compare(Buffer.from(data.buffer), Buffer.from(buffer))).toBe(0);
    }
    expect(await buffersMadeFor({ recordPrecision: 'paper' })).toContain('frame records');
    own.destroy();
    cloud.destroy();
  });

  for (const preset of ['fast', 'paper'] as const) {
    gpuTest(`preset ${preset}: finite and close, also in hard scenes`, async () => {
      const hard = [
        randomSplats({ count: 300, seed: 44, logScales: [-40, 40] }),
        randomSplats({ count: 300, seed: 45, halfExtent: 1e-4, logScales: [-18, 1] }),
        randomSplats({ count: 300, seed: 46, opacityLogits: [-6, 60], logScales: [-3, 1] }),
        splatsOf([{ position: [0, 0, 0], colorDc: [1e4, -1e4, 3e38], logScales: [1, -30, 1] }]),
      ];
      for (const set of hard) {
        const cloud = engine.add(set);
        for (const camera of [CAMERA, CAMERAS.inside, CAMERAS.orthographic]) {
          view.render({ camera, clouds: [{ cloud }], ...SIZE, accuracy: preset });
          const { data } = await view.readPixels();
          expect(data.every((value) => value >= 0 && value <= 1)).toBe(true);
        }
        cloud.destroy();
      }
      const cloud = engine.add(SCENE);
      view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE, accuracy: preset });
      const { data } = await view.readPixels();
      cloud.destroy();
      expect(psnrAgainstReference(data, ACCURACY_PRESETS[preset])).toBeGreaterThan(35);
    });
  }
});
