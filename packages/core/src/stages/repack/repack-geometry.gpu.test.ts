import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { RepackParameters } from '../../data/layout/packing-structs.ts';
import { logScalesOf } from '../../data/packing/chunks.ts';
import { type PackedGeometry, packGeometry } from '../../data/packing/geometry.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { unpackSplat } from '../../reference/packing.ts';
import { randomSplats, splatsOf } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { repackGeometry as reference } from './repack.reference.ts';
import { repackGeometry } from './repack.ts';

const gpu = testGpu();

const DISPATCH_ROW = 2;
/** Size of a 15-bit step in ±√½; rounding may go to either of two neighbouring steps. */
const ROTATION_STEP = Math.SQRT1_2 / 16383;
/** Largest error of a float32 logarithm. */
const LOG_ROUNDING = 4e-6;

async function repackOnGpu(finer: PackedGeometry, count: number): Promise<PackedGeometry> {
  const contents = RepackParameters.pack({ splatCount: count, dispatchRow: DISPATCH_ROW });
  const coarser = gpu.storage([], 32 * count);
  const bindings = {
    parameters: gpu.uniform(contents),
    finer: gpu.storage(finer.words),
    coarser,
    chunks: gpu.storage(finer.chunks),
  };
  const workgroups = Math.ceil(count / CHUNK_SPLATS);
  await gpu.run(repackGeometry, bindings, dispatchSize(workgroups, DISPATCH_ROW));
  return { ...finer, precision: 'packed', words: await gpu.read(coarser) };
}

/** Compares every splat's parts to within a step; positions, colours and zeros to the bit. */
async function check(set: SplatSet): Promise<void> {
  const finer = packGeometry(set, 'f32');
  const made = await repackOnGpu(finer, set.count);
  for (const expected of [reference(set, finer), packGeometry(set, 'packed')]) {
    for (let i = 0; i < set.count; i++) {
      const [a, b] = [made, expected].map((geometry) => unpackSplat(geometry, i));
      const at = `splat ${i}`;
      expect(made.words.subarray(8 * i, 8 * i + 4), at).toEqual(expected.words.subarray(8 * i, 8 * i + 4));
      expect(a.colorDc, at).toEqual(b.colorDc);
      expect(Math.abs(a.opacity - b.opacity), at).toBeLessThan(1.01 / 65535);
      const step = 1.01 * logScalesOf(finer.chunks, Math.floor(i / CHUNK_SPLATS)).step + LOG_ROUNDING;
      for (const axis of [0, 1, 2])
        expect(Math.abs(Math.log(a.scale[axis] / b.scale[axis])), at).toBeLessThanOrEqual(step);
      // Any of several components of equal size may be omitted, which may flip the sign of all.
      const dot = a.rotation.reduce((sum, value, k) => sum + value * b.rotation[k], 0);
      for (let k = 0; k < 4; k++) {
        const error = Math.abs(a.rotation[k] - Math.sign(dot) * b.rotation[k]);
        expect(error, `${at}, rotation ${k}`).toBeLessThan(4 * ROTATION_STEP);
      }
    }
  }
}

describe('repack-geometry', () => {
  gpuTest('packs as the host does', () => check(randomSplats({ count: 1500, shDegree: 0, seed: 31 })));

  gpuTest('the whole range of scales, in more than one row of workgroups', () =>
    check(randomSplats({ count: 700, shDegree: 0, seed: 32, logScales: [-40, 40] })),
  );

  gpuTest('equal scales, colours out of range, and each component omitted', () =>
    check(
      splatsOf(
        [1, -1].flatMap((sign) =>
          [0, 1, 2, 3].flatMap((k) =>
            [0, 1e-7, 2e-5, 0.3, 65519, 1e9].map((value) => ({
              position: [value, -value, 1e30],
              rotation: [0, 1, 2, 3].map((j) => (j === k ? sign : 0.3 * j * sign)),
              colorDc: [value, -value, 6e-8 * sign],
              opacityLogit: value === 0 ? Number.NEGATIVE_INFINITY : 20 * sign,
            })),
          ),
        ),
      ),
    ),
  );
});
