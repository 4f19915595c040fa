// Proves: rows packed by the GPU are those that the host packs.
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { type RowFacts, readRowFacts } from '../../clouds/ingest/row-facts.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { INGEST_FACTS } from '../../data/layout/ingest-facts.ts';
import { IngestParameters } from '../../data/layout/packing-structs.ts';
import { reachesOf } from '../../data/packing/band-reach.ts';
import { chunkCountOf, logScalesOf } from '../../data/packing/chunks.ts';
import { cloudFacts } from '../../data/packing/cloud-facts.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { clampLogScale } from '../../data/packing/log-scale.ts';
import type { RowPrecision } from '../../data/packing/precision.ts';
import { type ByteValues, valueOfByte } from '../../data/packing/row-layout.ts';
import { DROP_REASONS, type ShDegree, type SplatSet } from '../../data/splats/splat-set.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { expectSameGeometry, expectSameHarmonics } from '../../testing/expect-same-planes.ts';
import { type FileRowsOptions, fileRows } from '../../testing/file-rows.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { ingestRows as reference } from './ingest.reference.ts';
import { ingestRows, pieceParameters } from './ingest.ts';

const PACKED = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
const FINEST = { geometryPrecision: 'f32', shPrecision: 'f32' } as const;
/** Ends that no formula gives. */
const BYTE_VALUES: ByteValues = { least: -4, most: 4, scale: 1 / 32, offset: 1 / 64 - 4 };
const DISPATCH_ROW = 2;
/** The stage takes no coefficient for more than 1e18. */
const MAX_REACH = reachesOf([1e36, 1e36, 1e36]);
const isFull = process.env.WEBSPLATTER_FULL === '1';
/** Slots before the first row, in its page and in the cloud. */
const PAGE_SLOT = 256;
const CLOUD_SLOT = 512;

const HALVES = { geometryPrecision: 'packed', shPrecision: 'f16' } as const;
const DEGREES = [1, 2, 3] as const;
const PRECISIONS = [PACKED, FINEST, HALVES];

const gpu = testGpu();

interface TakeOptions extends FileRowsOptions {
  /** Default that of the rows. */
  readonly storedDegree?: ShDegree;
}

interface Taken {
  /** Of the rows alone. */
  readonly geometry: Uint32Array;
  readonly harmonics: Uint32Array;
  readonly rests: Uint32Array;
  readonly chunks: Float32Array<ArrayBuffer>;
  readonly dropped: readonly number[];
  readonly facts: RowFacts;
}

async function take(
  set: SplatSet,
  precision: RowPrecision,
  options: TakeOptions = {},
  shaders = gpu.pipelines,
): Promise<Taken> {
  const { bytes, layout, palette } = fileRows(set, options);
  const { count } = layout;
  const shDegree = options.storedDegree ?? layout.shDegree;
  const parameters = IngestParameters.pack({
    ...pieceParameters(layout, count),
    firstRow: 0,
    rowCount: count,
    pageSlot: PAGE_SLOT,
    maskRow: CLOUD_SLOT,
    dispatchRow: DISPATCH_ROW,
  });
  const geometryWords = GEOMETRY_WORDS[precision.geometryPrecision];
  const shWords = shWordsPerSplat(shDegree, precision.shPrecision);
  const padded = new Uint8Array(4 * Math.ceil(bytes.length / 4) + 4);
  padded.set(bytes);
  const buffer = (words: number) => gpu.storage([], 4 * words);
  const bindings = {
    parameters: gpu.uniform(parameters),
    rows: gpu.storage(new Uint32Array(padded.buffer)),
    geometry: buffer((PAGE_SLOT + count) * geometryWords),
    logScaleRests: buffer(CLOUD_SLOT + count),
    harmonics: buffer((PAGE_SLOT + count) * shWords),
    dropMask: buffer((CLOUD_SLOT + 256 * Math.ceil(count / 256)) / 32),
    facts: buffer(INGEST_FACTS.FACTS),
    chunks: buffer(CHUNK_WORDS.count * chunkCountOf(CLOUD_SLOT + count)),
    ...(palette && { palette: gpu.storage(new Uint32Array(palette.buffer)) }),
  };
  const hasByteHarmonics = layout.byteHarmonics !== undefined;
  const entryValues = layout.palette?.entryValues;
  const stage = ingestRows({ ...precision, shDegree, entryValues, hasByteHarmonics });
  const workgroups = Math.ceil(count / CHUNK_SPLATS);
  await gpu.run(stage, bindings, dispatchSize(workgroups, DISPATCH_ROW), shaders);
  const { dropMask, logScaleRests, ...made } = bindings;
  const [geometry, harmonics, rests, mask, facts, chunks] = await Promise.all(
    [made.geometry, made.harmonics, logScaleRests, dropMask, made.facts, made.chunks].map((each) =>
      gpu.read(each),
    ),
  );
  const isDropped = (row: number) => (mask[(CLOUD_SLOT + row) >>> 5] >>> (row & 31)) & 1;
  return {
    geometry: geometry.subarray(PAGE_SLOT * geometryWords),
    harmonics: harmonics.subarray(PAGE_SLOT * shWords, (PAGE_SLOT + count) * shWords),
    rests: rests.subarray(CLOUD_SLOT),
    chunks: new Float32Array(chunks.buffer.slice(32 * (CLOUD_SLOT / CHUNK_SPLATS))),
    dropped: Array.from({ length: count }, (_, row) => row).filter(isDropped),
    facts: readRowFacts(facts, { count, shDegree }),
  };
}

/** Random splats, and values at which floats are hard. */
function hardSplats(shDegree: 0 | 1 | 2 | 3): SplatSet {
  const set = randomSplats({ count: 700, seed: 70 + shDegree, shDegree, logScales: [-12, 3] });
  set.rotations.set([
    0, 0, 0, 0, 1e-41, -2e-41, 0, 1e-42, 1e-38, 1e-39, 0, 0, 3e38, -3e38, 0, 1e20, -0, 0, -1, 0,
  ]);
  set.opacityLogits.set([Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY, 300, -300, 88, -86.5, 0, -0]);
  const flat = Number.NEGATIVE_INFINITY;
  set.logScales.set([-1e30, 50, 40, -40, -1e-9, 1e-40, 0, -0, 0, flat, -2, -3, flat, flat, flat]);
  set.positions.set([1e-42, -0, 3e38, 0, -3e38, 1e-45]);
  set.colorDc.set([1e38, -1e38, 65519, 1e-7, 65520, -65536]);
  if (shDegree > 0) set.harmonics.coefficients.set([0, 0, 0, 1e30, -1e-30, 65504, 1e-9, 3e-6, 70000]);
  return set;
}

describe('ingest-rows', () => {
  for (const shDegree of [0, 1, 2, 3] as const) {
    // Halves are packed alike at every degree, beside geometry that is packed beside bytes too.
    for (const precision of isFull || shDegree === 3 ? PRECISIONS : [PACKED, FINEST]) {
      gpuTest(
        `degree ${shDegree}, ${Object.values(precision).join(' ')}: packs as the host does`,
        { tags: 'deeper' },
        async () => {
          const set = hardSplats(shDegree);
          const { geometry, harmonics, dropped, facts, rests, chunks } = await take(set, precision);
          const expected = reference(set, precision);
          expect(chunks).toEqual(expected.geometry.chunks);
          expectSameGeometry({ ...expected.geometry, words: geometry }, expected.geometry);
          expectSameHarmonics({ ...expected.harmonics, words: harmonics }, expected.harmonics, set.count);
          expect(dropped).toEqual([]);
          expectFacts(facts, set);
          if (precision.geometryPrecision === 'packed') expectLogScales(geometry, rests, chunks, set);
        },
      );
    }
  }

  for (const options of [{ isBigEndian: true }, { gapBytes: 1 }, { gapBytes: 3, isBigEndian: true }]) {
    gpuTest(`finds values anywhere: ${JSON.stringify(options)}`, async () => {
      const set = randomSplats({ count: 300, seed: 3, shDegree: 2 });
      const plain = await take(set, PACKED);
      expect(await take(set, PACKED, options)).toEqual(plain);
    });
  }

  /** Each degree and precision with another. */
  const someOfBytes = [
    [1, PACKED],
    [2, FINEST],
    [3, HALVES],
  ] as const;
  for (const [storedDegree, precision] of isFull ? pairsOf(DEGREES, PRECISIONS) : someOfBytes) {
    gpuTest(
      `takes harmonics from bytes: degree ${storedDegree} of 3, ${precision.shPrecision}`,
      { tags: 'deeper' },
      async () => {
        const set = hardSplats(3);
        const { coefficients } = set.harmonics;
        setToBytes(coefficients);
        const plain = await take(set, precision, { storedDegree });
        // Bytes begin anywhere in words.
        for (const gapBytes of [0, 1]) {
          const options = { storedDegree, gapBytes, byteValues: BYTE_VALUES };
          expect(await take(set, precision, options)).toEqual(plain);
        }
      },
    );
  }

  /** Palettes of degree 3 are drawn through an engine, in the test of the ingest of rows. */
  const someOfPalettes = [
    [1, FINEST],
    [2, PACKED],
  ] as const;
  for (const [storedDegree, precision] of isFull ? pairsOf(DEGREES, [PACKED, FINEST]) : someOfPalettes) {
    gpuTest(
      `takes harmonics from a palette: degree ${storedDegree} of 3, ${precision.shPrecision}`,
      { tags: 'deeper' },
      async () => {
        const set = hardSplats(3);
        // Every splat shares its harmonics with a neighbour, and some cannot be drawn.
        for (let i = 1; i < set.count; i += 2)
          set.harmonics.coefficients.copyWithin(45 * i, 45 * (i - 1), 45 * i);
        set.harmonics.coefficients.fill(Number.NaN, 45 * 8, 45 * 8 + 1);
        set.harmonics.coefficients.fill(Number.NaN, 45 * 9, 45 * 9 + 1);
        const plain = await take(set, precision, { storedDegree });
        expect(plain.dropped).toEqual([8, 9]);
        expect(await take(set, precision, { storedDegree, sharedBy: 2 })).toEqual(plain);
      },
    );
  }

  gpuTest('drops rows that are not finite, and counts them by reason', async () => {
    const set = randomSplats({ count: 600, seed: 5, shDegree: 1 });
    const bad = [Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
    const columns = [set.positions, set.logScales, set.rotations, set.opacityLogits, set.colorDc];
    const expected = new Map<number, string>();
    for (const [i, column] of columns.entries()) {
      const width = column.length / set.count;
      for (let k = 0; k < 20; k++) {
        const row = 29 * k + 3 * i;
        // Infinite logits are allowed, and log scales of −∞.
        column[row * width + (k % width)] = i === 3 ? Number.NaN : bad[k % (i === 1 ? 2 : 3)];
        expected.set(row, DROP_REASONS[i]);
      }
    }
    set.harmonics.coefficients[9 * 2 + 8] = Number.NaN;
    expected.set(2, 'non-finite-color');
    // Several reasons: the first counts.
    set.positions[3 * 3] = Number.NaN;
    expected.set(3, 'non-finite-position');
    const { dropped, facts, geometry } = await take(set, PACKED);
    expect(dropped).toEqual([...expected.keys()].sort((a, b) => a - b));
    const counts: Record<string, number> = {};
    for (const reason of expected.values()) counts[reason] = (counts[reason] ?? 0) + 1;
    expect(facts.dropped).toEqual(counts);
    expect(facts.count).toBe(set.count - expected.size);
    for (const row of dropped)
      expect(geometry.subarray(8 * row, 8 * row + 8).every((word) => word === 0)).toBe(true);
  });

  gpuTest('notices what must not be lost', async () => {
    // Only geometry is compared.
    const set = hardSplats(0);
    const expected = reference(set, PACKED);
    for (const [find, replace] of [
      ['if (largest >= TWO_TO_MINUS_60_BITS) { return bitcast<f32>(bits); }', 'return bitcast<f32>(bits);'],
      ['logScaleSteps(logScale, range, 1024.0)', 'logScaleSteps(logScale, range, 1023.0)'],
      ['select(1.0, 0.0,', 'select(0.0, 1.0,'],
    ]) {
      const mutated = new Pipelines(gpu.device, { file: 'stages/ingest-rows', find, replace });
      const { geometry } = await take(set, PACKED, {}, mutated);
      const made = { ...expected.geometry, words: geometry };
      expect(() => expectSameGeometry(made, expected.geometry), find).toThrow();
    }
  });

  gpuTest('notices bytes of harmonics that are decoded wrongly', { tags: 'deeper' }, async () => {
    const set = randomSplats({ count: 300, seed: 4, shDegree: 1 });
    setToBytes(set.harmonics.coefficients);
    const { harmonics } = await take(set, FINEST);
    const faults = [
      ['f32(byte) * values.x + values.y', 'f32(byte) * values.x'],
      ['byte == 255u', 'byte == 256u'],
      ['byte == 0u', 'byte == 256u'],
      ['extractBits(rows[at / 4u], 8u * (at % 4u), 8u)', 'extractBits(rows[at / 4u], 0u, 8u)'],
    ];
    for (const [find, replace] of isFull ? faults : faults.slice(0, 1)) {
      const mutated = new Pipelines(gpu.device, { file: 'stages/ingest-rows', find, replace });
      const found = await take(set, FINEST, { byteValues: BYTE_VALUES }, mutated);
      expect(found.harmonics, find).not.toEqual(harmonics);
    }
  });
});

function pairsOf<A, B>(as: readonly A[], bs: readonly B[]): (readonly [A, B])[] {
  return as.flatMap((a) => bs.map((b) => [a, b] as const));
}

function setToBytes(coefficients: Float32Array): void {
  for (let i = 0; i < coefficients.length; i++) coefficients[i] = valueOfByte(BYTE_VALUES, (37 * i) & 255);
}

function expectFacts(found: RowFacts, set: SplatSet): void {
  const { shBandReach, ...facts } = cloudFacts(set);
  expect(found.facts).toMatchObject(facts);
  for (const [i, reach] of shBandReach.entries())
    expect(Math.abs(found.facts.shBandReach[i] / Math.min(reach, MAX_REACH[i]) - 1)).toBeLessThan(1e-6);
  const values = (axis: number) => set.positions.filter((_, i) => i % 3 === axis);
  for (const axis of [0, 1, 2]) {
    expect(found.min[axis]).toBe(Math.min(...values(axis)));
    expect(found.max[axis]).toBe(Math.max(...values(axis)));
  }
}

/** Steps and rests of the log scales together, to 2⁻²² of the chunk's range. */
function expectLogScales(
  geometry: Uint32Array,
  rests: Uint32Array,
  chunks: Float32Array,
  set: SplatSet,
): void {
  for (let i = 0; i < set.count; i++) {
    const { min, step } = logScalesOf(chunks, Math.floor(i / CHUNK_SPLATS));
    const steps = [geometry[8 * i + 5] & 0xffff, geometry[8 * i + 5] >>> 16, geometry[8 * i + 6] & 0xffff];
    for (const [axis, whole] of steps.entries()) {
      const parts = whole + (((rests[i] >>> (10 * axis)) & 0x3ff) - 512) / 1024;
      const away = min + step * parts - clampLogScale(set.logScales[3 * i + axis]);
      expect(Math.abs(away)).toBeLessThanOrEqual((65535 * step) / 2 ** 22);
    }
  }
}
