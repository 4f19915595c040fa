import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { BufferParameters } from '../../data/layout/packing-structs.ts';
import { chunkCountOf, logScalesOf } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../../data/packing/geometry.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { GPU_FAULTS } from '../../data/splats/splat-set.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { unpackSplat } from '../../reference/packing.ts';
import { dispatchSize } from '../../stages/dispatch.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { type BufferColumns, packBuffers as reference } from './pack-buffers.reference.ts';
import { packBuffers } from './pack-buffers.stages.ts';

const gpu = testGpu();

const COUNT = 700;
const DISPATCH_ROW = 2;
const BOUNDS = { min: [-4, -4, -4], max: [4, 4, 4] } as const;
/** Largest errors: of float32, of its logarithms, and half a step of what is packed. */
const FLOAT = 1e-6;
const LOG_SCALE = 1e-5;
const STEPS: Readonly<Record<GeometryPrecision, { opacity: number; rotation: number; color: number }>> = {
  f32: { opacity: FLOAT, rotation: FLOAT, color: FLOAT },
  packed: { opacity: 0.51 / 65535, rotation: (2 * Math.SQRT1_2) / 16383, color: 1.01 * 2 ** -11 },
};

/** Random splats, some of them with a fault, and a chunk with none to draw. */
function columnsOf(hasRest: boolean): BufferColumns {
  const random = seededRandom(7);
  const list = (width: number, least: number, most: number) =>
    Float32Array.from({ length: width * COUNT }, () => least + (most - least) * random());
  const columns = {
    positions: list(3, -3.9, 3.9),
    scales: list(3, -0.2, 0.2),
    colors: list(3, 0, 1),
    rotations: hasRest ? list(4, -9, 9) : null,
    opacities: hasRest ? list(1, -0.2, 1.2) : null,
  };
  const { NaN: nan, POSITIVE_INFINITY: infinite } = Number;
  columns.positions.set([nan, 0, 0, 0, infinite, 0], 0);
  columns.scales.set([1, -infinite, 1], 3 * 2);
  columns.colors.set([0, 0, nan], 3 * 3);
  columns.positions.set([0, 0, 4.01], 3 * 4);
  columns.rotations?.set([0, nan, 0, 1, 0, 0, 0, 0, 1e35, 0, 0, 0, 0, 1e-25, 0, 1e-25], 4 * 5);
  columns.opacities?.set([infinite], 9);
  columns.positions.fill(nan, 3 * CHUNK_SPLATS, 6 * CHUNK_SPLATS);
  return columns;
}

interface Packed {
  readonly geometry: PackedGeometry;
  readonly faults: readonly number[];
}

/** Column by column in one buffer, of which splats leave a word free. */
async function packOnGpu(
  columns: BufferColumns,
  precision: GeometryPrecision,
  shaders = gpu.pipelines,
): Promise<Packed> {
  const { positions, scales, rotations, opacities, colors } = columns;
  const mixed: number[] = [];
  const places = [positions, scales, rotations, opacities, colors].map((values) => {
    if (!values) return [0, 0, 0, 0];
    const first = mixed.length;
    const width = values.length / COUNT;
    for (let i = 0; i < COUNT; i++) mixed.push(...values.subarray(width * i, width * (i + 1)), 0);
    return [first, width + 1, 0, 0];
  });
  const buffer = gpu.storage(Float32Array.from(mixed));
  const contents = BufferParameters.pack({
    boundsMin: BOUNDS.min,
    boundsMax: BOUNDS.max,
    splatCount: COUNT,
    dispatchRow: DISPATCH_ROW,
    columns: places.flat(),
  });
  const geometry = gpu.storage([], 4 * COUNT * GEOMETRY_WORDS[precision]);
  const chunks = gpu.storage([], 4 * CHUNK_WORDS.count * chunkCountOf(COUNT));
  const faults = gpu.storage([], 4 * GPU_FAULTS.length);
  const stage = packBuffers({
    geometryPrecision: precision,
    hasRotations: rotations !== null,
    hasOpacities: opacities !== null,
    countsFaults: true,
  });
  const columnBindings = {
    positions: buffer,
    scales: buffer,
    rotations: buffer,
    opacities: buffer,
    colors: buffer,
  };
  const bindings = { ...columnBindings, parameters: gpu.uniform(contents), geometry, chunks, faults };
  const workgroups = dispatchSize(chunkCountOf(COUNT), DISPATCH_ROW);
  await gpu.run(stage, bindings, workgroups, shaders);
  const made = { precision, words: await gpu.read(geometry) };
  return {
    geometry: { ...made, chunks: new Float32Array((await gpu.read(chunks)).buffer) },
    faults: Array.from(await gpu.read(faults)),
  };
}

/** Largest errors against the reference, in parts of those that are allowed. */
function errorOf({ geometry, faults }: Packed, expected: ReturnType<typeof reference>): number {
  const allowed = STEPS[geometry.precision];
  let largest = faults.some((count, i) => count !== expected.faults[i]) ? Number.POSITIVE_INFINITY : 0;
  const note = (error: number, most: number) => {
    largest = Math.max(largest, error / most);
  };
  for (const [i, b] of expected.splats.entries()) {
    const a = unpackSplat(geometry, i);
    if (!b) {
      note(a.opacity, FLOAT);
      continue;
    }
    const { step } = logScalesOf(geometry.chunks, Math.floor(i / CHUNK_SPLATS));
    const dot = a.rotation.reduce((sum, value, k) => sum + value * b.rotation[k], 0);
    note(Math.abs(a.opacity - b.opacity), allowed.opacity);
    for (let k = 0; k < 4; k++)
      note(Math.abs(a.rotation[k] - Math.sign(dot) * b.rotation[k]), allowed.rotation);
    for (let k = 0; k < 3; k++) {
      note(Math.abs(a.position[k] - b.position[k]), FLOAT);
      note(Math.abs(a.colorDc[k] - b.colorDc[k]), allowed.color);
      const logError = Math.abs(Math.log(a.scale[k] / b.scale[k]));
      note(logError, LOG_SCALE + (geometry.precision === 'packed' ? 0.51 * step : 0));
    }
  }
  return largest;
}

describe('pack-buffers', () => {
  for (const precision of ['f32', 'packed'] as const) {
    for (const hasRest of [true, false]) {
      gpuTest(
        `packs as the reference does, ${precision}, ${hasRest ? 'all columns' : 'needed columns'}`,
        async () => {
          const columns = columnsOf(hasRest);
          const made = await packOnGpu(columns, precision);
          expect(errorOf(made, reference(columns, COUNT, BOUNDS))).toBeLessThan(1);
        },
      );
    }

    gpuTest(`bounds the drawn splats of each chunk, bit for bit, ${precision}`, async () => {
      const columns = columnsOf(true);
      const { chunks } = (await packOnGpu(columns, precision)).geometry;
      const { splats } = reference(columns, COUNT, BOUNDS);
      for (let chunk = 0; chunk < chunkCountOf(COUNT); chunk++) {
        const drawn = splats
          .slice(chunk * CHUNK_SPLATS, (chunk + 1) * CHUNK_SPLATS)
          .filter((each) => each !== null);
        const at = CHUNK_WORDS.count * chunk;
        for (let axis = 0; axis < 3; axis++) {
          const values = drawn.map(({ position }) => position[axis]);
          // A chunk without splats is a point that no splat has.
          const [least, most] = values.length > 0 ? [Math.min(...values), Math.max(...values)] : [0, 0];
          expect(chunks[at + CHUNK_WORDS.minPosition + axis]).toBe(least);
          expect(chunks[at + CHUNK_WORDS.maxPosition + axis]).toBe(most);
        }
        expect(chunks[at + CHUNK_WORDS.minLogScale] < -40).toBe(drawn.length === 0);
      }
    });
  }

  const mistakes = {
    'quaternions whose real part is the first': ['.wxyz', '.xyzw'],
    'linear colours': ['(color - 0.5) * COEFFICIENT', 'color * COEFFICIENT'],
    'opacities beyond 1': ['clamp(bitcast<f32>(bits), 0.0, 1.0)', 'bitcast<f32>(bits)'],
    'values that are not finite': ['if (!areFinite(bitsOf3(index, 4u))) { return NON_FINITE_COLOR; }', ''],
    'splats out of bounds': ['any(place > parameters.boundsMax)', 'false'],
  } as const;
  for (const [what, [find, replace]] of Object.entries(mistakes)) {
    gpuTest(`${what} are noticed`, async () => {
      const columns = columnsOf(true);
      const shaders = new Pipelines(gpu.device, { file: 'stages/pack-buffers', find, replace });
      const made = await packOnGpu(columns, 'f32', shaders);
      expect(errorOf(made, reference(columns, COUNT, BOUNDS))).toBeGreaterThan(10);
    });
  }
});
