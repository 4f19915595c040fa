import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { MorphParameters } from '../../data/layout/packing-structs.ts';
import { logScalesOf } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../../data/packing/geometry.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { unpackSplat } from '../../reference/packing.ts';
import { dispatchSize } from '../../stages/dispatch.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { morphGeometry as reference } from './morph.reference.ts';
import { morphGeometry } from './morph.stages.ts';
import { SplatMorph } from './splat-morph.data.ts';

const gpu = testGpu();

const COUNT = 700;
const DISPATCH_ROW = 2;
/** Largest errors: of float32, of its logarithms and exponentials, and half a step of what is packed. */
const FLOAT = 1e-6;
const LOG_SCALE = 1e-5;
const STEPS: Readonly<Record<GeometryPrecision, { opacity: number; rotation: number; color: number }>> = {
  f32: { opacity: FLOAT, rotation: FLOAT, color: FLOAT },
  packed: { opacity: 0.51 / 65535, rotation: (2 * Math.SQRT1_2) / 16383, color: 1.01 * 2 ** -11 },
};

function statesOf(precision: GeometryPrecision): [PackedGeometry, PackedGeometry] {
  const from = randomSplats({ count: COUNT, shDegree: 0, seed: 61 });
  const to = randomSplats({ count: COUNT, shDegree: 0, seed: 62, logScales: [-9, 1], halfExtent: 5 });
  // The same rotation, and one that differs by its sign alone.
  to.rotations.set(from.rotations.subarray(0, 8));
  for (let k = 4; k < 8; k++) to.rotations[k] *= -1;
  from.opacityLogits[0] = Number.POSITIVE_INFINITY;
  to.opacityLogits[0] = Number.NEGATIVE_INFINITY;
  const { packed, second } = new SplatMorph(from, to, { geometryPrecision: precision, shPrecision: 'u8' });
  return [packed.geometry, second.geometry];
}

async function morphOnGpu(
  [first, second]: readonly [PackedGeometry, PackedGeometry],
  amount: number,
  shaders = gpu.pipelines,
): Promise<PackedGeometry> {
  const { precision, chunks } = first;
  const contents = MorphParameters.pack({ splatCount: COUNT, dispatchRow: DISPATCH_ROW, amount });
  const morphed = gpu.storage([], 4 * COUNT * GEOMETRY_WORDS[precision]);
  const bindings = {
    parameters: gpu.uniform(contents),
    first: gpu.storage(first.words),
    second: gpu.storage(second.words),
    morphed,
    chunks: gpu.storage(chunks),
  };
  const workgroups = dispatchSize(Math.ceil(COUNT / CHUNK_SPLATS), DISPATCH_ROW);
  await gpu.run(morphGeometry(precision), bindings, workgroups, shaders);
  return { precision, chunks, words: await gpu.read(morphed) };
}

/** Largest errors against the reference, in parts of those that are allowed. */
function errorOf(made: PackedGeometry, expected: ReturnType<typeof reference>): number {
  const { precision, chunks } = made;
  const allowed = STEPS[precision];
  let largest = 0;
  const note = (error: number, most: number) => {
    largest = Math.max(largest, error / most);
  };
  for (const [i, b] of expected.entries()) {
    const a = unpackSplat(made, i);
    const { step } = logScalesOf(chunks, Math.floor(i / CHUNK_SPLATS));
    const dot = a.rotation.reduce((sum, value, k) => sum + value * b.rotation[k], 0);
    note(Math.abs(a.opacity - b.opacity), allowed.opacity);
    for (let k = 0; k < 4; k++)
      note(Math.abs(a.rotation[k] - Math.sign(dot) * b.rotation[k]), allowed.rotation);
    for (let k = 0; k < 3; k++) {
      note(Math.abs(a.position[k] - b.position[k]), 5 * FLOAT);
      note(Math.abs(a.colorDc[k] - b.colorDc[k]), allowed.color);
      const logError = Math.abs(Math.log(a.scale[k] / b.scale[k]));
      note(logError, LOG_SCALE + (precision === 'packed' ? 0.51 * step : 0));
    }
  }
  return largest;
}

describe('morph-geometry', () => {
  for (const precision of ['f32', 'packed'] as const) {
    const states = statesOf(precision);
    for (const amount of [0, 0.3, 0.5, 1]) {
      gpuTest(`blends as the reference does, ${precision}, at ${amount}`, async () => {
        const made = await morphOnGpu(states, amount);
        expect(errorOf(made, reference(...states, COUNT, amount))).toBeLessThan(1);
      });
    }
    gpuTest(`is either set at its end, bit for bit, ${precision}`, async () => {
      for (const [amount, { words }] of states.entries())
        expect((await morphOnGpu(states, amount)).words).toEqual(words);
    });
    gpuTest(`keeps centres within the bounds of both, ${precision}`, async () => {
      const made = await morphOnGpu(states, 0.7);
      for (let i = 0; i < COUNT; i++) {
        const [a, b, blended] = [...states, made].map((each) => unpackSplat(each, i).position);
        for (let axis = 0; axis < 3; axis++) {
          expect(blended[axis]).toBeGreaterThanOrEqual(Math.min(a[axis], b[axis]));
          expect(blended[axis]).toBeLessThanOrEqual(Math.max(a[axis], b[axis]));
        }
      }
    });
  }

  for (const amount of [0, 0.5, 1]) {
    gpuTest(`leaves flat splats finite, at ${amount}`, async () => {
      const [from, to] = [63, 64].map((seed) => randomSplats({ count: COUNT, shDegree: 0, seed }));
      // Too small for float32.
      for (const [set, row] of [
        [from, 0],
        [to, 1],
        [from, 2],
        [to, 2],
      ] as const)
        set.logScales[3 * row] = -200;
      const { packed, second } = new SplatMorph(from, to, { geometryPrecision: 'f32', shPrecision: 'u8' });
      const made = await morphOnGpu([packed.geometry, second.geometry], amount);
      const values = new Float32Array(made.words.buffer, made.words.byteOffset, made.words.length);
      expect(values.every(Number.isFinite)).toBe(true);
    });
  }

  const faults = {
    'rotations along the longer arc': ['-b.rotation, dot', 'b.rotation, dot'],
    'sizes blended linearly': ['exp(blend3(logOf(a.scale), logOf(b.scale)))', 'blend3(a.scale, b.scale)'],
    'values of the first set alone': ['b * parameters.amount', 'a * parameters.amount'],
  } as const;
  for (const [what, [find, replace]] of Object.entries(faults)) {
    gpuTest(`${what} are noticed`, async () => {
      const states = statesOf('f32');
      const shaders = new Pipelines(gpu.device, { file: 'stages/morph-geometry', find, replace });
      const made = await morphOnGpu(states, 0.3, shaders);
      expect(errorOf(made, reference(...states, COUNT, 0.3))).toBeGreaterThan(10);
    });
  }
});
