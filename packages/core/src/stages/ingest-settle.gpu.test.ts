import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { SettleParameters } from '../layout/packing-structs.ts';
import { packGeometry } from '../packing/geometry.ts';
import { INGEST_LOG_SCALES, ingestLogScaleSteps } from '../packing/ingest-log-scale.ts';
import { clampLogScale } from '../packing/log-scale.ts';
import type { GeometryPrecision } from '../packing/precision.ts';
import { ingestSettle as reference } from '../reference/ingest-settle.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { expectSameGeometry } from '../testing/expect-same-planes.ts';
import { runStage, storageBuffer, uniformBuffer } from '../testing/gpu-buffers.ts';
import { type RandomSplatOptions, randomSplats } from '../testing/random-splats.ts';
import { dispatchSize } from './dispatch.ts';
import { ingestSettle } from './ingest-settle.ts';

const DISPATCH_ROW = 2;
const FIRST_SLOT = 512;

let device: GPUDevice;
let pipelines: Pipelines;
beforeAll(async () => {
  device = await shareTestDevice();
  pipelines = new Pipelines(device);
});
afterAll(() => device.destroy());

/** Settles what the reference of ingest-rows leaves of `set`. */
async function settle(
  set: SplatSet,
  precision: GeometryPrecision,
  origin: SplatSet['origin'],
  { min, step } = reference(set, precision, origin).logScaleRange,
): Promise<Uint32Array> {
  const steps = Array.from(set.logScales, (value) => ingestLogScaleSteps(clampLogScale(value)));
  const taken = packGeometry(set, precision, INGEST_LOG_SCALES).words;
  const rests = new Uint32Array(FIRST_SLOT + set.count);
  for (let i = 0; i < set.count; i++) {
    const [x, y, z] = steps.slice(3 * i, 3 * i + 3);
    rests[FIRST_SLOT + i] = (x & 0x3ff) | ((y & 0x3ff) << 10) | ((z & 0x3ff) << 20);
    if (precision === 'f32') continue;
    taken[8 * i + 5] = (x >>> 10) | ((y >>> 10) << 16);
    taken[8 * i + 6] = ((taken[8 * i + 6] >>> 16) << 16) | (z >>> 10);
  }
  const parameters = SettleParameters.pack({
    origin,
    logScaleStep: step,
    minLogScale: ingestLogScaleSteps(min),
    slotCount: set.count,
    firstSlot: FIRST_SLOT,
    dispatchRow: DISPATCH_ROW,
  });
  const geometry = storageBuffer(device, taken);
  const bindings = {
    parameters: uniformBuffer(device, parameters),
    geometry,
    logScaleRests: storageBuffer(device, rests),
  };
  const workgroups = Math.ceil(set.count / CHUNK_SPLATS);
  const size = dispatchSize(workgroups, DISPATCH_ROW);
  await runStage(device, pipelines, ingestSettle(precision), bindings, size);
  return readWords(device, geometry);
}

describe('ingest-settle', () => {
  const sets: Record<string, Partial<RandomSplatOptions>> = {
    'of all sizes': { logScales: [-40, 40] },
    'of usual sizes': { logScales: [-9, -1] },
    'of nearly one size': { logScales: [-3.2, -3] },
    'of one size': { logScales: [-3, -3] },
  };
  for (const [name, options] of Object.entries(sets)) {
    for (const precision of ['packed', 'f32'] as const) {
      gpuTest(`${precision}: splats ${name}, as the host packs them`, async () => {
        const set = randomSplats({ count: 600, seed: 9, shDegree: 0, ...options });
        const expected = reference(set, precision, [0, 0, 0]);
        const words = await settle(set, precision, [0, 0, 0]);
        expectSameGeometry({ ...expected, words }, expected);
      });
    }
  }

  gpuTest('moves positions about the origin, exactly, and leaves the other axes as they are', async () => {
    const set = randomSplats({ count: 300, seed: 4, shDegree: 0 });
    for (let i = 0; i < set.count; i++) set.positions[3 * i] += 1000;
    set.positions[1] = -0;
    set.positions[4] = 1e-42;
    for (const precision of ['packed', 'f32'] as const) {
      const expected = reference(set, precision, [1000, 0, 0]);
      const words = await settle(set, precision, [1000, 0, 0]);
      expectSameGeometry({ ...expected, words }, expected);
      expect(Math.max(...expected.words)).toBeGreaterThan(0);
    }
  });

  gpuTest('a smallest log scale that is off by a step is noticed', async () => {
    const set = randomSplats({ count: 300, seed: 4, shDegree: 0, logScales: [-9, -1] });
    const expected = reference(set, 'packed', [0, 0, 0]);
    const { min, step } = expected.logScaleRange;
    const words = await settle(set, 'packed', [0, 0, 0], { min: min + step, step });
    expect(() => expectSameGeometry({ ...expected, words }, expected)).toThrow();
  });
});
