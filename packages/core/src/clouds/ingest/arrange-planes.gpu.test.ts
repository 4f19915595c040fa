import { gpuTest } from '@websplatter/node/gpu-test';
import fc from 'fast-check';
import { describe, expect } from 'vitest';
import { GEOMETRY_WORDS, packGeometry } from '../../data/packing/geometry.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { mortonFrame, mortonOrder, permuteSplats } from '../../data/packing/morton-order.ts';
import type { RowPrecision } from '../../data/packing/precision.ts';
import { packHarmonics, repackHarmonics, truncateHarmonics } from '../../data/packing/repack-harmonics.ts';
import type { ShDegree, SplatSet } from '../../data/splats/splat-set.ts';
import { GpuMemory } from '../../gpu/gpu-memory.ts';
import { arrivedGeometry } from '../../testing/arrived-geometry.ts';
import { expectSameChunks, expectSameGeometry } from '../../testing/expect-same-planes.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { ScarceMemory } from '../../testing/scarce-memory.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import type { PageRange, Plane } from '../cloud-planes.ts';
import { type ArrangedPlanes, type ArrivedPlanes, arrangePlanes, arrangeStages } from './arrange-planes.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';
const PACKED = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
const HALVES = { geometryPrecision: 'packed', shPrecision: 'f16' } as const;
const FINEST = { geometryPrecision: 'f32', shPrecision: 'f32' } as const;

/** Content of a dropped row's place in the planes: a NaN in each word. */
const HOLE = 0x7fc00001;
const PAGE_SPLATS = 512;
const ALL = 0xffffffff;
/** Bits of packed words that are no log scales, where they are not all. */
const KEPT_BITS: Readonly<Record<number, number>> = { 5: 0, 6: 0xffff0000 };
/** Keys and payloads, which the sort holds besides the order: more than moving words takes. */
const WORK_BYTES_PER_SPLAT = 8;

const gpu = testGpu();

interface Rows {
  readonly set: SplatSet;
  readonly isDropped: (row: number) => boolean;
  readonly precision: RowPrecision;
  readonly keptShDegree: ShDegree;
  readonly pageSplats: number;
  /** Splats per page in storage order; null: as in the file. */
  readonly storedPageSplats: number | null;
  readonly hasRoom: boolean;
}

/** A set in which every third splat lies where the first does, so that the file's order decides. */
function withTies(count: number, shDegree: ShDegree): SplatSet {
  const set = randomSplats({ count, seed: count, shDegree });
  for (let i = 0; i < count; i += 3) set.positions.copyWithin(3 * i, 0, 3);
  return set;
}

const rowsOf = (count: number, shDegree: ShDegree, changes: Partial<Rows> = {}): Rows => ({
  set: withTies(count, shDegree),
  isDropped: () => false,
  precision: PACKED,
  keptShDegree: shDegree,
  pageSplats: PAGE_SPLATS,
  storedPageSplats: null,
  hasRoom: true,
  ...changes,
});

const pagesOf = (count: number, pageSplats: number): PageRange[] =>
  Array.from({ length: Math.ceil(count / pageSplats) }, (_, page) => ({
    start: page * pageSplats,
    end: Math.min(count, (page + 1) * pageSplats),
  }));

/** The rows as the host arranges them. */
function onHost({ set, isDropped, precision, keptShDegree }: Rows) {
  const packed = repackHarmonics(packHarmonics(set.harmonics), set.count, precision.shPrecision);
  const kept = permuteSplats(
    { ...set, harmonics: packed },
    Uint32Array.from(set.fileIndices.filter((row) => !isDropped(row))),
  );
  const stored = permuteSplats(kept, mortonOrder(kept.positions, kept.count));
  return {
    harmonicsInFile: packed,
    kept,
    stored,
    geometry: packGeometry(stored, precision.geometryPrecision),
    harmonics: truncateHarmonics(stored.harmonics, stored.count, keptShDegree),
  };
}

/** The rows as they arrive on the GPU: a slot for each in the order of the file. */
function arrivedOf(rows: Rows, memory: GpuMemory): ArrivedPlanes {
  const { set, isDropped, precision, keptShDegree, pageSplats, storedPageSplats, hasRoom } = rows;
  const { harmonicsInFile, kept } = onHost(rows);
  const ranges = pagesOf(set.count, pageSplats);
  const dropMask = new Uint32Array(Math.ceil(set.count / 32));
  for (const row of set.fileIndices) if (isDropped(row)) dropMask[row >> 5] |= 1 << (row & 31);
  const planeOf = (words: Uint32Array, perSplat: number): Plane => {
    const holed = words.map((word, i) => (isDropped(Math.floor(i / perSplat)) ? HOLE : word));
    return ranges.map(({ start, end }) => filled(memory, holed.subarray(start * perSplat, end * perSplat)));
  };
  const inFile = arrivedGeometry(set, precision.geometryPrecision);
  const axes = [0, 1, 2].map((axis) => kept.positions.filter((_, i) => i % 3 === axis));
  return {
    ...precision,
    name: 'rows',
    ranges,
    geometry: planeOf(inFile.words, GEOMETRY_WORDS[precision.geometryPrecision]),
    harmonics: set.harmonics.degree > 0 ? planeOf(harmonicsInFile.words, harmonicsInFile.wordsPerSplat) : [],
    shDegree: set.harmonics.degree,
    dropMask: filled(memory, dropMask),
    kept: kept.count,
    hasRoom,
    frame: mortonFrame(
      axes.map((values) => Math.min(...values)),
      axes.map((values) => Math.max(...values)),
    ),
    origin: [0, 0, 0],
    arrivedChunks: filled(memory, new Uint32Array(inFile.chunks.buffer)),
    logScaleRests: precision.geometryPrecision === 'packed' ? filled(memory, inFile.rests) : null,
    keptShDegree,
    ...(storedPageSplats && { pages: pagesOf(kept.count, storedPageSplats) }),
  };
}

/** A buffer made by `memory` that can be read back. */
function filled(memory: GpuMemory, words: Uint32Array): GPUBuffer {
  const { STORAGE, COPY_SRC, COPY_DST } = GPUBufferUsage;
  const buffer = memory.createBuffer('test', words.byteLength, STORAGE | COPY_SRC | COPY_DST);
  gpu.device.queue.writeBuffer(buffer, 0, Uint32Array.from(words));
  return buffer;
}

function buffersOf({ geometry, harmonics, chunks, fileRows }: ArrangedPlanes): readonly GPUBuffer[] {
  return [...geometry, ...harmonics, ...chunks, fileRows];
}

/** The parts that stay with the caller. */
function lentOf({ dropMask, arrivedChunks, logScaleRests }: ArrivedPlanes): readonly GPUBuffer[] {
  return [dropMask, arrivedChunks, ...(logScaleRests ? [logScaleRests] : [])];
}

const bytesOf = (buffers: readonly GPUBuffer[]) => buffers.reduce((sum, { size }) => sum + size, 0);

/** The words of the splats of a plane, `perSplat` each. */
async function planeWords(plane: Plane, { ranges }: ArrangedPlanes, perSplat: number): Promise<Uint32Array> {
  const pages = await Promise.all(plane.map((page) => gpu.read(page)));
  return joinedWords(
    pages.map((words, i) => words.subarray(0, perSplat * (ranges[i].end - ranges[i].start))),
  );
}

function joinedWords(parts: readonly Uint32Array[]): Uint32Array<ArrayBuffer> {
  const words = new Uint32Array(parts.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const part of parts) {
    words.set(part, at);
    at += part.length;
  }
  return words;
}

/**
 * Arranges the rows, and expects what the host makes of them, bit for bit but for log scales, which
 * are rounded to chunks.
 *
 * @returns the most bytes that were held at once beside the given planes and those returned.
 */
async function check(rows: Rows): Promise<{ readonly workBytes: number }> {
  const { precision, keptShDegree, set } = rows;
  const expected = onHost(rows);
  const hasDrops = expected.stored.count < set.count;
  await gpu.pipelines.prepare(arrangeStages(precision, hasDrops));
  const memory = new GpuMemory(gpu.device);
  const arrived = arrivedOf(rows, memory);
  const arrivedBytes = memory.report().totalBytes;
  const arranged = arrangePlanes({ ...gpu, memory, dispatchRow: 2 }, arrived);

  expect((await gpu.read(arranged.fileRows)).subarray(0, arrived.kept)).toEqual(expected.stored.fileIndices);
  expect(arranged.ranges.at(-1)!.end).toBe(arrived.kept);
  const geometryWords = GEOMETRY_WORDS[precision.geometryPrecision];
  const words = await planeWords(arranged.geometry, arranged, geometryWords);
  const chunkPages = await Promise.all(arranged.chunks.map((page) => gpu.read(page)));
  const chunks = new Float32Array(joinedWords(chunkPages).buffer);
  const withoutLogScales = (geometry: Uint32Array) =>
    geometry.map((word, i) => word & (KEPT_BITS[i % 8] ?? ALL));
  if (precision.geometryPrecision === 'f32') expect(words).toEqual(expected.geometry.words);
  else expect(withoutLogScales(words)).toEqual(withoutLogScales(expected.geometry.words));
  expectSameGeometry({ ...expected.geometry, words, chunks }, expected.geometry);
  expectSameChunks(chunks, expected.geometry.chunks);
  const shWords = shWordsPerSplat(keptShDegree, precision.shPrecision);
  expect(await planeWords(arranged.harmonics, arranged, shWords)).toEqual(expected.harmonics.words);
  const { totalBytes, peakBytes } = memory.report();
  expect(totalBytes, 'only what was returned is left').toBe(
    bytesOf([...buffersOf(arranged), ...lentOf(arrived)]),
  );
  for (const buffer of [...buffersOf(arranged), ...lentOf(arrived)]) memory.destroy(buffer);
  const given = [...arrived.geometry, ...arrived.harmonics];
  const madeBytes = bytesOf(buffersOf(arranged).filter((buffer) => !given.includes(buffer)));
  return { workBytes: peakBytes - arrivedBytes - madeBytes };
}

describe('planes in the order of a file become those that the host makes', () => {
  for (const shDegree of [0, 1, 2, 3] as const) {
    for (const precision of [PACKED, HALVES, FINEST]) {
      const { geometryPrecision, shPrecision } = precision;
      gpuTest(`degree ${shDegree}, ${geometryPrecision}, ${shPrecision}, three pages`, async () => {
        await check(rowsOf(1300, shDegree, { precision }));
      });
    }
  }

  for (const count of [1, 255, 256, 257]) {
    gpuTest(`${count} splats`, () => check(rowsOf(count, 1)));
  }

  for (const [what, isDropped] of [
    ['a few rows', (row: number) => row % 97 === 5],
    ['a whole page', (row: number) => row >= 512 && row < 1024],
    ['half of the rows', (row: number) => row % 2 === 0],
    ['all rows but one', (row: number) => row !== 700],
  ] as const) {
    gpuTest(`without ${what}`, async () => {
      await check(rowsOf(1300, 2, { isDropped }));
      await check(rowsOf(1300, 2, { isDropped, hasRoom: false }));
      await check(rowsOf(1300, 3, { isDropped, precision: FINEST, keptShDegree: 1 }));
    });
  }

  for (const keptShDegree of [0, 1, 2] as const) {
    for (const precision of [PACKED, HALVES, FINEST]) {
      gpuTest(`of degree 3, ${precision.shPrecision}, of which ${keptShDegree} is kept`, async () => {
        await check(rowsOf(700, 3, { precision, keptShDegree }));
      });
    }
  }

  for (const storedPageSplats of [256, 512, 768, 2048]) {
    gpuTest(`in pages of ${storedPageSplats} splats, from pages of 512`, async () => {
      await check(rowsOf(1300, 1, { storedPageSplats }));
      await check(rowsOf(1300, 2, { storedPageSplats, keptShDegree: 0, isDropped: (row) => row % 97 === 5 }));
    });
  }

  const permutation = 'in an order that is a stable permutation of the rows kept, for any places';
  gpuTest(permutation, { tags: 'deeper' }, async () => {
    const coordinate = fc.oneof(fc.constantFrom(0, -0, 1e-42, 1, -3e38), fc.float({ noNaN: true }));
    const row = fc.record({
      position: fc.tuple(coordinate, coordinate, coordinate).filter((each) => each.every(Number.isFinite)),
      isDropped: fc.boolean(),
    });
    await fc.assert(
      fc.asyncProperty(fc.array(row, { minLength: 1, maxLength: 60 }), async (list) => {
        const set = randomSplats({ count: list.length, shDegree: 0 });
        set.positions.set(list.flatMap(({ position }) => position));
        // At least one row is kept.
        await check(rowsOf(0, 0, { set, isDropped: (i) => i > 0 && list[i].isDropped }));
      }),
      { numRuns: isFull ? 40 : 10 },
    );
  });

  gpuTest('with no more than eight bytes per splat beside what is given and returned', async () => {
    const { workBytes } = await check(rowsOf(20_000, 0, { pageSplats: 1 << 20 }));
    // Not per splat: parameters of each dispatch, and digit counts.
    expect(workBytes).toBeLessThan(WORK_BYTES_PER_SPLAT * 20_000 + 65_536);
    // Dropped rows leave their slots to the planes if there is no room.
    const isDropped = (row: number) => row % 2 === 0;
    const half = await check(rowsOf(20_000, 0, { pageSplats: 1 << 20, isDropped, hasRoom: false }));
    expect(half.workBytes).toBeLessThan(WORK_BYTES_PER_SPLAT * 20_000 + 65_536);
  });
});

gpuTest('memory that runs out at any buffer leaves the given planes, and nothing else', async () => {
  const rows = rowsOf(700, 2, { keptShDegree: 1, isDropped: (row) => row % 3 === 1 });
  await gpu.pipelines.prepare(arrangeStages(rows.precision, true));
  const owner = new GpuMemory(gpu.device);
  const arrange = (memory: GpuMemory, arrived: ArrivedPlanes) =>
    arrangePlanes({ ...gpu, memory, dispatchRow: 2 }, arrived);
  const enough = new ScarceMemory(gpu.device, Number.POSITIVE_INFINITY);
  arrange(enough, arrivedOf(rows, owner));
  enough.destroyAll();
  owner.destroyAll();

  const arrived = arrivedOf(rows, owner);
  const givenBytes = owner.report().totalBytes;
  for (let buffers = 0; buffers < enough.buffersMade; buffers++) {
    const memory = new ScarceMemory(gpu.device, buffers);
    expect(() => arrange(memory, arrived), `with ${buffers} buffers`).toThrow('no more buffers');
    expect(memory.report().totalBytes, `with ${buffers} buffers`).toBe(0);
  }
  // A buffer that was destroyed cannot be read.
  await gpu.read(arrived.geometry[0]);
  expect(owner.report().totalBytes).toBe(givenBytes);
  owner.destroyAll();
});
