import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { MortonParameters } from '../../data/layout/packing-structs.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { GEOMETRY_WORDS, packGeometry } from '../../data/packing/geometry.ts';
import { type MortonFrame, mortonFrame } from '../../data/packing/morton-order.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { ingestKeys as reference } from './ingest.reference.ts';
import { ingestKeys } from './ingest.ts';

const COUNT = 700;
const DISPATCH_ROW = 2;
/** Two pages. */
const PAGES = [
  [0, 512],
  [512, COUNT],
] as const;
const isDropped = (splat: number) => splat % 7 === 3;

const gpu = testGpu();

function frameOf({ positions }: SplatSet): MortonFrame {
  const axes = [0, 1, 2].map((axis) => positions.filter((_, i) => i % 3 === axis));
  return mortonFrame(
    axes.map((values) => Math.min(...values)),
    axes.map((values) => Math.max(...values)),
  );
}

async function keysOf(
  set: SplatSet,
  order: Uint32Array,
  round: number,
  precision: GeometryPrecision,
  { shaders = gpu.pipelines, origin = [0, 0, 0] as Vec3 } = {},
) {
  const moved = set.positions.map((value, i) => value + origin[i % 3]);
  const { words } = packGeometry({ ...set, positions: moved }, precision);
  const width = GEOMETRY_WORDS[precision];
  const dropMask = new Uint32Array(Math.ceil(COUNT / 32));
  for (let i = 0; i < COUNT; i++) if (isDropped(i)) dropMask[i >> 5] |= 1 << (i & 31);
  const shared = {
    dropMask: gpu.storage(dropMask),
    order: gpu.storage(order),
    keys: gpu.storage([], 4 * COUNT),
    payloads: gpu.storage([], 4 * COUNT),
  };
  for (const [pageStart, pageEnd] of PAGES) {
    const sizes = { pageStart, pageEnd, slotCount: COUNT, dispatchRow: DISPATCH_ROW };
    const parameters = gpu.uniform(MortonParameters.pack({ ...frameOf(set), origin, round, ...sizes }));
    const geometry = gpu.storage(words.subarray(pageStart * width, pageEnd * width));
    const size = dispatchSize(Math.ceil(COUNT / 256), DISPATCH_ROW);
    await gpu.run(ingestKeys(precision), { ...shared, parameters, geometry }, size, shaders);
  }
  return { keys: await gpu.read(shared.keys), payloads: await gpu.read(shared.payloads) };
}

describe('ingest-keys', () => {
  const slots = Uint32Array.from({ length: COUNT }, (_, i) => i);
  const shuffled = slots.map((i) => (i * 311) % COUNT);
  for (const [what, change] of Object.entries({
    'in a cube': () => {},
    'far apart': (set: SplatSet) => set.positions.set([3e38, -3e38, 1e-42, 1e-38, -1e-40, 0]),
    'close together': (set: SplatSet) => {
      for (let i = 0; i < set.positions.length; i++) set.positions[i] *= 1e-36;
    },
    'in a plane': (set: SplatSet) => {
      for (let i = 1; i < set.positions.length; i += 3) set.positions[i] = 5;
    },
    'at one point': (set: SplatSet) => set.positions.fill(1e30),
  })) {
    for (const precision of ['packed', 'f32'] as const) {
      gpuTest(`splats ${what}, ${precision}: the keys of the reference, bit for bit`, async () => {
        const set = randomSplats({ count: COUNT, seed: 6, shDegree: 0 });
        change(set);
        for (let round = 0; round < 6; round++) {
          const order = round === 0 ? slots : shuffled;
          const { keys, payloads } = await keysOf(set, shuffled, round, precision);
          expect(payloads).toEqual(order);
          expect(keys).toEqual(reference(set.positions, order, frameOf(set), round, isDropped));
        }
      });
    }
  }

  gpuTest('the keys are of places about the origin of the cloud', async () => {
    const set = randomSplats({ count: COUNT, seed: 6, shDegree: 0 });
    // No digit is lost so far from the origin.
    for (let i = 0; i < set.positions.length; i++)
      set.positions[i] = Math.round(set.positions[i] * 1024) / 1024;
    const { keys } = await keysOf(set, shuffled, 5, 'packed', { origin: [500, 0, -1000] });
    expect(keys).toEqual(reference(set.positions, shuffled, frameOf(set), 5, isDropped));
  });

  gpuTest('a code without dropped rows, or with other cells, is noticed', async () => {
    const set = randomSplats({ count: COUNT, seed: 6, shDegree: 0 });
    const expected = reference(set.positions, shuffled, frameOf(set), 5, isDropped);
    for (const [find, replace] of [
      ['isDropped << 8u', '0u'],
      ['0.0, 65535.0', '0.0, 30000.0'],
    ]) {
      const mutated = new Pipelines(gpu.device, { file: 'stages/ingest-keys', find, replace });
      expect((await keysOf(set, shuffled, 5, 'packed', { shaders: mutated })).keys).not.toEqual(expected);
    }
  });
});
