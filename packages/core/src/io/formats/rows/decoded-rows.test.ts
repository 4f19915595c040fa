import { describe, expect, test } from 'vitest';
import { SplatFileError } from '../../../data/errors.ts';
import type { PackedHarmonics } from '../../../data/packing/harmonics.ts';
import type { RowLayout } from '../../../data/packing/row-layout.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import type { ShDegree, SplatSet } from '../../../data/splats/splat-set.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { ByteReader } from '../../sources/byte-reader.ts';
import { openSource } from '../../sources/open-source.ts';
import type { LoadProgress } from '../../sources/splat-source.ts';
import { type DecodedRows, deliverRows, rowLength } from './decoded-rows.ts';
import type { RowSink } from './row-sink.ts';

/** Random rows, as a format decodes them. */
function decodedRows(count: number, shDegree: ShDegree, isAntialiased?: boolean): DecodedRows {
  const { positions, logScales, rotations, opacityLogits, colorDc, harmonics } = randomSplats({
    count,
    shDegree,
  });
  const length = rowLength(shDegree);
  const values = Array.from({ length: count }, (_, i) => [
    ...positions.subarray(3 * i, 3 * i + 3),
    ...logScales.subarray(3 * i, 3 * i + 3),
    ...rotations.subarray(4 * i, 4 * i + 4),
    opacityLogits[i],
    ...colorDc.subarray(3 * i, 3 * i + 3),
    ...harmonics.coefficients.subarray(
      (length - ROW_SLOT.harmonics) * i,
      (length - ROW_SLOT.harmonics) * (i + 1),
    ),
  ]).flat();
  let row = 0;
  return {
    count,
    shDegree,
    isAntialiased,
    decode(rows, rowCount) {
      rows.set(values.slice(row * length, (row + rowCount) * length));
      row += rowCount;
    },
  };
}

const OPTIONS = {
  shPrecision: 'f32',
  maxSplats: Number.POSITIVE_INFINITY,
  maxBytes: Number.POSITIVE_INFINITY,
} as const;

const NAMES = { name: 'test', fileNames: [] };

async function inputOf(bytes = new Uint8Array(100)) {
  const opened = await openSource({ kind: 'bytes', bytes, ...NAMES });
  return { ...opened, reader: new ByteReader(opened) };
}

class Taken implements RowSink {
  readonly mayDetach = false;
  layout: RowLayout | undefined;
  readonly bytes: number[] = [];

  async begin(layout: RowLayout): Promise<void> {
    this.layout = layout;
  }

  async memory(): Promise<Uint8Array<ArrayBuffer>> {
    const { count, pieceRows, strideBytes } = this.layout!;
    return new Uint8Array(Math.min(count, pieceRows) * strideBytes);
  }

  take(rowCount: number, rows: Uint8Array<ArrayBuffer>): void {
    this.bytes.push(...rows.subarray(0, rowCount * this.layout!.strideBytes));
  }
}

/** Compares bits: Vitest takes seconds for as many numbers. */
const isSame = (a: ArrayBufferView, b: ArrayBufferView) =>
  Buffer.from(a.buffer, a.byteOffset, a.byteLength).equals(Buffer.from(b.buffer, b.byteOffset, b.byteLength));

/** Delivers rows that no sink takes. */
async function setOf(rows: DecodedRows): Promise<SplatSet<PackedHarmonics>> {
  const set = await deliverRows(rows, await inputOf(), OPTIONS, undefined);
  return set === 'passed' ? expect.fail('no sink was given') : set;
}

describe('decoded rows', () => {
  test.each([
    [0, 4097],
    [1, 300],
    [2, 300],
    [3, 300],
  ] as const)('of degree %i, %i of them, become a set', async (shDegree, count) => {
    const { harmonics, ...expected } = randomSplats({ count, shDegree });
    const set = await setOf(decodedRows(count, shDegree));
    for (const column of [
      'positions',
      'logScales',
      'rotations',
      'opacityLogits',
      'colorDc',
      'fileIndices',
    ] as const)
      expect(isSame(set[column], expected[column]), column).toBe(true);
    expect(isSame(set.harmonics.words, harmonics.coefficients)).toBe(true);
    expect(set).toMatchObject({ count, origin: [0, 0, 0], dropped: {} });
    expect('isAntialiased' in set).toBe(false);
  });

  test('go to a sink as float32, in pieces of whole chunks, where it takes as many', async () => {
    const [count, shDegree] = [2000, 1] as const;
    const sink = new Taken();
    const rowsTo = { sink, files: { minRows: count, maxRows: count, pieceBytes: 100_000 } };
    const rows = decodedRows(count, shDegree, true);
    expect(await deliverRows(rows, await inputOf(), OPTIONS, rowsTo)).toBe('passed');
    expect(sink.layout).toMatchObject({
      count,
      shDegree,
      strideBytes: 92,
      pieceRows: 1024,
      isAntialiased: true,
    });
    const expected = new Float32Array(count * rowLength(shDegree));
    decodedRows(count, shDegree).decode(expected, count);
    expect(isSame(Uint8Array.from(sink.bytes), expected)).toBe(true);

    for (const files of [
      { minRows: count + 1, maxRows: 10_000, pieceBytes: 1 },
      { minRows: 1, maxRows: count - 1, pieceBytes: 1 },
    ]) {
      const set = await deliverRows(decodedRows(count, shDegree), await inputOf(), OPTIONS, {
        sink: new Taken(),
        files,
      });
      expect(set).toMatchObject({ count });
    }
  });

  test('that share harmonics go to a sink after these, with the index of an entry each', async () => {
    const [count, entryCount, length] = [600, 500, ROW_SLOT.harmonics + 1];
    const { decode } = decodedRows(count, 0);
    const entries = Float32Array.from({ length: entryCount * 9 }, (_, i) => i);
    let row = 0;
    const palette: DecodedRows['palette'] = {
      entryCount,
      entryValues: 9,
      values: () => entries,
      decode(values, rowCount) {
        for (let i = 0; i < rowCount; i++) values.fill(row + i, i * length, (i + 1) * length);
        row += rowCount;
      },
    };
    const sink = new Taken();
    const taken: number[] = [];
    const take = (rowCount: number, memory: Uint8Array<ArrayBuffer>) => {
      taken.push(rowCount);
      const { palette: isNext } = taken.length <= 2 ? sink.layout! : {};
      sink.bytes.push(...memory.subarray(0, 4 * (isNext ? rowCount : rowCount * length)));
    };
    const rowsTo = {
      sink: { mayDetach: false, begin: sink.begin.bind(sink), memory: sink.memory.bind(sink), take },
      files: { minRows: 1, maxRows: count, pieceBytes: 60 * 256 },
    };
    let arrivals = 0;
    const rows: DecodedRows = {
      count,
      shDegree: 1,
      palette,
      decode,
      arrive: async (rowCount) => {
        expect(sink.layout).toBeDefined();
        arrivals += rowCount;
      },
    };
    expect(await deliverRows(rows, await inputOf(), OPTIONS, rowsTo)).toBe('passed');
    expect(sink.layout).toMatchObject({ strideBytes: 60, palette: { entryCount, entryValues: 9 } });
    // As much of the palette as a piece of rows has values, twice; then the rows.
    expect(taken).toEqual([3840, 660, 256, 256, 88]);
    expect(arrivals).toBe(count);
    const values = new Float32Array(Uint8Array.from(sink.bytes).buffer);
    expect([...values.subarray(0, entries.length)]).toEqual([...entries]);
    const indices = values.subarray(entries.length).filter((_, i) => i % length === length - 1);
    expect([...indices]).toEqual(Array.from({ length: count }, (_, i) => i));

    const set = await deliverRows({ ...rows, ...decodedRows(count, 1) }, await inputOf(), OPTIONS, undefined);
    expect(set).toMatchObject({ count, harmonics: { degree: 1 } });
  });

  test('say what the file says of an antialias filter', async () => {
    for (const isAntialiased of [true, false]) {
      const set = await deliverRows(decodedRows(1, 0, isAntialiased), await inputOf(), OPTIONS, undefined);
      expect(set).toMatchObject({ isAntialiased });
    }
  });

  test('that are not finite are left out and counted', async () => {
    const rows = decodedRows(3, 0);
    const decode: DecodedRows['decode'] = (values, rowCount) => {
      rows.decode(values, rowCount);
      values[rowLength(0) + ROW_SLOT.logScale] = Number.POSITIVE_INFINITY;
    };
    const set = await setOf({ ...rows, decode });
    expect(set).toMatchObject({ count: 2, dropped: { 'non-finite-scale': 1 } });
    expect([...set.fileIndices]).toEqual([0, 2]);
  });

  test('are refused where there are none, or too many, before any is decoded', async () => {
    const decode = () => expect.fail('decoded');
    const deliver = async (count: number) =>
      deliverRows({ count, shDegree: 0, decode }, await inputOf(), { ...OPTIONS, maxSplats: 10 }, undefined);
    await expect(deliver(0)).rejects.toThrow(SplatFileError);
    await expect(deliver(0)).rejects.toMatchObject({ code: 'empty' });
    await expect(deliver(11)).rejects.toMatchObject({ code: 'too-large' });
  });

  test('end when the load is aborted, and report how far they are', async () => {
    const stop = new AbortController();
    const opened = await openSource({ kind: 'bytes', bytes: new Uint8Array(8), ...NAMES });
    const reader = new ByteReader(opened, stop.signal);
    await reader.fill(8);
    reader.advance(8);
    const seen: LoadProgress[] = [];
    const onProgress = (progress: LoadProgress) => seen.push(progress);
    const options = { ...OPTIONS, onProgress };
    await deliverRows(decodedRows(5000, 0), { ...opened, reader }, options, undefined);
    expect(seen.at(-1)).toMatchObject({ phase: 'read', loadedBytes: 8, totalBytes: 8, splats: 5000 });
    stop.abort(new Error('enough'));
    const ending = deliverRows(decodedRows(5000, 0), { ...opened, reader }, options, undefined);
    await expect(ending).rejects.toThrow('enough');
  });
});
