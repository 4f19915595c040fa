import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { ChunkParameters } from '../../data/layout/packing-structs.ts';
import { Chunk } from '../../data/layout/structs.ts';
import { chunkCountOf, logScalesOf } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../../data/packing/geometry.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { arrivedGeometry } from '../../testing/arrived-geometry.ts';
import { expectSameChunks, expectSameGeometry } from '../../testing/expect-same-planes.ts';
import { type RandomSplatOptions, randomSplats } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { ingestChunks as reference } from './ingest.reference.ts';
import { ingestChunks } from './ingest.ts';

const DISPATCH_ROW = 2;
/** Splats of the cloud before those of the page. */
const FIRST_SPLAT = 512;
const FORMS = ['packed', 'f32'] as const;

const gpu = testGpu();

/** Settles the splats of `set`, which came in the reverse order. */
async function settle(
  set: SplatSet,
  precision: GeometryPrecision,
  { origin = [0, 0, 0] as SplatSet['origin'], shaders = gpu.pipelines } = {},
): Promise<PackedGeometry> {
  const { count } = set;
  const reversed = (column: Float32Array, width: number) =>
    column.map((_, i) => column[width * (count - 1 - Math.floor(i / width)) + (i % width)]);
  const arrived = arrivedGeometry(
    {
      ...set,
      positions: reversed(set.positions, 3),
      logScales: reversed(set.logScales, 3),
      rotations: reversed(set.rotations, 4),
      opacityLogits: reversed(set.opacityLogits, 1),
      colorDc: reversed(set.colorDc, 3),
    },
    precision,
  );
  const width = GEOMETRY_WORDS[precision];
  const stored = arrived.words.map(
    (_, i) => arrived.words[width * (count - 1 - Math.floor(i / width)) + (i % width)],
  );
  const fileRows = Uint32Array.from({ length: FIRST_SPLAT + count }, (_, i) => FIRST_SPLAT + count - 1 - i);
  const parameters = { origin, firstSplat: FIRST_SPLAT, splatCount: count, dispatchRow: DISPATCH_ROW };
  const geometry = gpu.storage(stored);
  const chunks = gpu.storage([], Chunk.bytes * chunkCountOf(count));
  const bindings = {
    parameters: gpu.uniform(ChunkParameters.pack(parameters)),
    geometry,
    chunks,
    fileRows: gpu.storage(fileRows),
    arrivedChunks: gpu.storage(arrived.chunks),
    logScaleRests: gpu.storage(arrived.rests),
  };
  const size = dispatchSize(chunkCountOf(count), DISPATCH_ROW);
  await gpu.run(ingestChunks(precision), bindings, size, shaders);
  const [words, chunkWords] = [await gpu.read(geometry), await gpu.read(chunks)];
  return { precision, words, chunks: new Float32Array(chunkWords.buffer) };
}

describe('ingest-chunks', () => {
  for (const count of [1, 256, 257, 1500]) {
    for (const precision of FORMS) {
      gpuTest(
        `${count} splats, ${precision}: bounds are exact, log scales as the host packs them`,
        async () => {
          const set = randomSplats({ count, seed: count, shDegree: 0, logScales: [-30, 30] });
          set.positions.set([-0, 1e-42, -3e38]);
          const expected = reference(set, precision, [0, 0, 0]);
          const settled = await settle(set, precision);
          expectSameChunks(settled.chunks, expected.chunks);
          expectSameGeometry(settled, expected);
        },
      );
    }
  }

  const sets: Record<string, Partial<RandomSplatOptions>> = {
    'of all sizes': { logScales: [-40, 40] },
    'of usual sizes': { logScales: [-9, -1] },
    'of nearly one size': { logScales: [-3.2, -3] },
  };
  for (const [name, options] of Object.entries(sets)) {
    for (const precision of FORMS) {
      gpuTest(`${precision}: splats ${name}, as the host packs them`, async () => {
        const set = randomSplats({ count: 600, seed: 9, shDegree: 0, ...options });
        // Each chunk has a range of its own.
        for (let i = 0; i < set.logScales.length; i++) set.logScales[i] *= 1 - Math.floor(i / 768) / 4;
        const expected = reference(set, precision, [0, 0, 0]);
        expectSameGeometry(await settle(set, precision), expected);
      });
    }
  }

  gpuTest('splats of one size have it to the bit', async () => {
    const set = randomSplats({ count: 600, shDegree: 0, logScales: [-4.60517, -4.60517] });
    const { chunks, words } = await settle(set, 'packed');
    for (const chunk of [0, 1, 2])
      expect(logScalesOf(chunks, chunk)).toEqual({ min: set.logScales[0], step: 0 });
    expect(words).toEqual(reference(set, 'packed', [0, 0, 0]).words);
  });

  gpuTest('moves positions about the origin, exactly, and leaves the other axes as they are', async () => {
    const set = randomSplats({ count: 300, seed: 4, shDegree: 0 });
    for (let i = 0; i < set.count; i++) set.positions[3 * i] += 1000;
    set.positions[1] = -0;
    set.positions[4] = 1e-42;
    for (const precision of FORMS) {
      const expected = reference(set, precision, [1000, 0, 0]);
      const settled = await settle(set, precision, { origin: [1000, 0, 0] });
      expectSameGeometry(settled, expected);
      expectSameChunks(settled.chunks, expected.chunks);
      expect(Math.max(...expected.words)).toBeGreaterThan(0);
    }
  });

  for (const [find, replace] of [
    ['let ordered = ', 'let ordered = 1u + '],
    ['let row = ', 'let row = 1u + '],
    ['(vec3f(rests) - 512.0) / 1024.0', '0.0'],
    ['logScaleSteps(logScale, range, 1.0)', 'logScaleSteps(logScale + vec3f(2.0 * range.y), range, 1.0)'],
  ]) {
    gpuTest(`an inexact step is noticed: ${replace}`, async () => {
      const set = randomSplats({ count: 300, seed: 1, shDegree: 0, logScales: [-9, -1] });
      const mutated = new Pipelines(gpu.device, { file: 'stages/ingest-chunks', find, replace });
      const expected = reference(set, 'packed', [0, 0, 0]);
      const settled = await settle(set, 'packed', { shaders: mutated });
      expect(() => {
        expectSameChunks(settled.chunks, expected.chunks);
        expectSameGeometry(settled, expected);
      }).toThrow();
    });
  }
});
