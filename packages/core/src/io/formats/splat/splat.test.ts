import { describe, expect, test } from 'vitest';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { chunked, plyBytes, splatElement } from '../../../testing/ply-fixture.ts';
import { outcomeOf } from '../../../testing/read-damaged.ts';
import { rowsOf } from '../../../testing/rows-of.ts';
import { seededRandom } from '../../../testing/seeded-random.ts';
import { slowFile } from '../../../testing/slow-file.ts';
import { readSplats } from '../../loading/read-splats.ts';
import type { LoadProgress } from '../../sources/splat-source.ts';
import { SPLAT_FORMATS } from '../formats.ts';

const SH_C0 = 0.28209479177387814;

interface Row {
  readonly position: readonly number[];
  readonly scale: readonly number[];
  /** Red, green, blue, opacity. */
  readonly rgba: readonly number[];
  readonly rotation: readonly number[];
}

const plain: Row = {
  position: [1, 2, 3],
  scale: [1, 2, 4],
  rgba: [0, 128, 255, 128],
  rotation: [255, 0, 128, 64],
};

function encode(rows: readonly Row[]): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(32 * rows.length);
  const view = new DataView(bytes.buffer);
  for (const [i, { position, scale, rgba, rotation }] of rows.entries()) {
    for (const [k, value] of [...position, ...scale].entries()) view.setFloat32(32 * i + 4 * k, value, true);
    bytes.set([...rgba, ...rotation], 32 * i + 24);
  }
  return bytes;
}

const read = (bytes: Uint8Array, name = 'scene.splat') => readSplats(bytes, { name, shPrecision: 'f32' });

function randomRows(count: number, seed = 1): Row[] {
  const random = seededRandom(seed);
  const list = (length: number, next: () => number) => Array.from({ length }, next);
  return list(count, random).map(() => ({
    position: list(3, () => Math.fround(20 * random() - 10)),
    scale: list(3, () => Math.fround(Math.exp(-8 * random()))),
    rgba: list(4, () => Math.floor(256 * random())),
    rotation: list(4, () => Math.floor(256 * random())),
  }));
}

describe('reads', () => {
  test('every field', async () => {
    const set = await read(
      encode([plain, { ...plain, rgba: [1, 2, 3, 0] }, { ...plain, rgba: [1, 2, 3, 255] }]),
    );
    expect(set).toMatchObject({
      count: 3,
      dropped: {},
      harmonics: { degree: 0 },
      fileFacts: { format: 'splat' },
    });
    expect(set.isAntialiased).toBeUndefined();
    expect([0, 1, 2].map((axis) => set.positions[axis] + set.origin[axis])).toEqual([1, 2, 3]);
    expect([...set.logScales.subarray(0, 3)]).toEqual([0, Math.log(2), Math.log(4)].map(Math.fround));
    expect([...set.rotations.subarray(0, 4)]).toEqual([127.5, -127.5, 0, -63.5].map((part) => part / 128));
    const colors = [0, 128, 255].map((byte) => Math.fround((byte / 255 - 0.5) / SH_C0));
    expect([...set.colorDc.subarray(0, 3)]).toEqual(colors);
    expect([...set.opacityLogits]).toEqual([Math.fround(Math.log(128 / 127)), -Infinity, Infinity]);
  });

  test('rows go to the GPU while others are on their way, and all of the file is counted', async () => {
    const bytes = encode(randomRows(10_000));
    const lastAt = bytes.length - 40;
    let taken = 0;
    let takenBeforeLast = -1;
    const file = slowFile('a.splat', bytes, [bytes.subarray(0, lastAt), bytes.subarray(lastAt)], async () => {
      // The last bytes come when nothing else can be done.
      for (let turn = 0; turn < 10; turn++) await new Promise((resolve) => setImmediate(resolve));
      takenBeforeLast = taken;
    });
    const reports: LoadProgress[] = [];
    const onProgress = (progress: LoadProgress) => reports.push(progress);
    const { values } = await rowsOf(file, { onProgress }, 2048 * 56, (rowCount) => {
      taken += rowCount;
    });
    expect(takenBeforeLast).toBe(4 * 2048);
    expect(reports.at(-1)).toMatchObject({ loadedBytes: bytes.length, splats: 10_000 });
    const all = await rowsOf(new File([bytes], 'a.splat'), {}, 2048 * 56);
    expect(Buffer.from(values.buffer).equals(Buffer.from(all.values.buffer))).toBe(true);
  });

  test('streams of unknown size', async () => {
    const bytes = encode(randomRows(100));
    const expected = await read(bytes);
    expect(await readSplats(chunked(bytes, [7, 100]), { name: 'a.splat', shPrecision: 'f32' })).toEqual(
      expected,
    );
  });

  test('a scale of 0 is flat and changes nothing else; rows that are no numbers are dropped', async () => {
    const rows = randomRows(6);
    const expected = await read(encode(rows));
    const changed = rows.with(1, { ...rows[1], scale: [0.5, 0, 0.25] });
    const flat = await read(encode(changed));
    expect([...flat.logScales.subarray(3, 6)]).toEqual([Math.log(0.5), -20, Math.log(0.25)].map(Math.fround));
    expect([...flat.logScales.subarray(6)]).toEqual([...expected.logScales.subarray(6)]);
    const bad = changed
      .with(2, { ...rows[2], scale: [1, 1, -1] })
      .with(3, { ...rows[3], scale: [Number.NaN, 1, 1] })
      .with(4, { ...rows[4], position: [0, Number.POSITIVE_INFINITY, 0] });
    expect(await read(encode(bad))).toMatchObject({
      count: 3,
      dropped: { 'non-finite-scale': 2, 'non-finite-position': 1 },
    });
  });

  test('other files with that name keep their format', async () => {
    const bytes = plyBytes({ format: 'ascii', elements: [splatElement(3)] });
    expect((await read(bytes)).fileFacts?.format).not.toBe('splat');
    const { recognise } = SPLAT_FORMATS.find(({ name }) => name === 'splat')!;
    for (const start of ['\x1f\x8b\x08\0', 'PK\x03\x04', '\x28\xb5\x2f\xfd', '\0\x01\0\0'])
      expect(recognise(Buffer.from(start.padEnd(32, '\xff'), 'latin1'), 'a.splat')).toBe(false);
    for (const x of [0, 1, -1e-9])
      expect(recognise(encode([{ ...plain, position: [x, 0, 0] }]), 'a.SPLAT')).toBe(true);
  });
});

describe('doubtful rows', () => {
  const absurd = { scale: [1e-30, 1, 1] };
  const rowsWith = (count: number, doubtful: number) =>
    randomRows(count).map((row, i) => (i < doubtful ? { ...row, ...absurd } : row));

  /**
   * @fault Files: any other binary file that is named .splat
   * @consequence `SplatFileError` `unknown-format`; if a tenth of the first rows is absurd, a note in
   *   `fileFacts`
   */
  test.each([
    [1000, 65, 'refused'],
    [1000, 64, 'noted'],
    [1000, 14, 'noted'],
    [1000, 12, 'read'],
    [3, 2, 'refused'],
    [3, 1, 'noted'],
  ])('of %i rows, %i with an absurd scale are %s', async (count, doubtful, outcome) => {
    const reading = read(encode(rowsWith(count, doubtful)));
    if (outcome === 'refused') {
      expect(await fileErrorOf(reading)).toMatchObject({ code: 'unknown-format' });
      return;
    }
    const set = await reading;
    expect(set.count).toBe(count);
    const of = Math.min(count, 128);
    expect(set.fileFacts?.notes).toEqual(
      outcome === 'noted' ? [expect.stringContaining(`${doubtful} of its first ${of} rows`)] : undefined,
    );
  });

  test('are not splats of sizes that scenes have', async () => {
    for (const size of [0, 1e-9, 1e-6, 1, 1e4, 1e6]) {
      const rows = randomRows(100).map((row) => ({ ...row, scale: [size, 1e-3, 1e-3] }));
      expect((await read(encode(rows))).fileFacts).toEqual({ format: 'splat' });
    }
  });
});

describe('refuses', () => {
  test.each([
    ['a web page', Buffer.from('<!doctype html><title>404</title>'.padEnd(64)), 'unknown-format', /web page/],
    ['nothing', new Uint8Array(0), 'empty', /is empty/],
    ['half a row', encode([plain, plain]).subarray(0, 48), 'truncated', /48 bytes are not a multiple of 32/],
  ] as const)('%s', async (_, bytes, code, says) => {
    const error = await fileErrorOf(read(bytes));
    expect(error.code).toBe(code);
    expect(error.message).toMatch(says);
  });

  /** How other binary files begin. */
  const begins: readonly [string, string][] = [
    ['PNG', '\x89PNG\r\n\x1a\n\0\0\0\rIHDR'],
    ['JPEG', '\xff\xd8\xff\xe0\0\x10JFIF'],
    ['GIF', 'GIF89a\x01\0\x01\0'],
    ['WebP', 'RIFF\x10\0\0\0WEBPVP8L'],
    ['ELF', '\x7fELF\x02\x01\x01\0'],
    ['a program of Windows', 'MZ\x90\0\x03\0\0\0'],
    ['a program of macOS', '\xcf\xfa\xed\xfe\x07\0\0\x01'],
    ['WebAssembly', '\0asm\x01\0\0\0'],
    ['PDF', '%PDF-1.7\n%\xe2\xe3'],
    ['7z', '7z\xbc\xaf\x27\x1c\0\x04'],
    ['xz', '\xfd7zXZ\0\0\x04'],
    ['bzip2', 'BZh91AY&SY'],
    ['RAR', 'Rar!\x1a\x07\x01\0'],
    ['SQLite', 'SQLite format 3\0'],
    ['HDF5', '\x89HDF\r\n\x1a\n'],
    ['NumPy', '\x93NUMPY\x01\0'],
    ['MP4', '\0\0\0\x20ftypisom'],
    ['Matroska', '\x1a\x45\xdf\xa3\x01\0'],
    ['Ogg', 'OggS\0\x02\0\0'],
    ['LAS', 'LASF\0\0\0\0'],
    ['TIFF', 'II*\0\x08\0\0\0'],
  ];
  test.each(begins)('%s', async (_, start) => {
    const bytes = encode(randomRows(100));
    bytes.set(Buffer.from(start, 'latin1'));
    expect(await fileErrorOf(read(bytes))).toMatchObject({ code: 'unknown-format' });
  });

  test.each<[string, (random: () => number, i: number) => number]>([
    ['random bytes', (random) => Math.floor(256 * random())],
    ['zeros', () => 0],
    ['bytes of 255', () => 255],
    ['whole numbers of 32 bits', (random, i) => (i % 4 < 2 ? Math.floor(256 * random()) : 0)],
    ['sound of 16 bits', (random, i) => Math.floor(i % 2 === 0 ? 256 * random() : 4 * random()) & 255],
  ])('%s, whole or in pieces', async (_, byteAt) => {
    const random = seededRandom(7);
    const bytes = Uint8Array.from({ length: 32 * 500 }, (_, i) => byteAt(random, i));
    // Else its first row may be text.
    bytes[0] = 0x80;
    const readings = [
      () => read(bytes),
      () => readSplats(chunked(bytes, [100]), { name: 'a.splat' }),
      () => rowsOf(new File([bytes], 'a.splat')),
    ];
    for (const reading of readings) {
      expect(await fileErrorOf(reading())).toMatchObject({
        code: 'unknown-format',
        message: expect.stringMatching(/\d+ of its first 128 rows .* no scene has/),
      });
    }
  });

  test('the same bytes by another name', async () => {
    expect((await fileErrorOf(read(encode([plain]), 'scene.bin'))).code).toBe('unknown-format');
  });

  test('more splats than allowed, as soon as that is known', async () => {
    const bytes = encode(randomRows(100));
    const options = { name: 'a.splat', maxSplats: 99 };
    expect((await fileErrorOf(readSplats(bytes, options))).code).toBe('too-large');
    let given = 0;
    const endless = new ReadableStream<Uint8Array>({
      pull: (controller) => {
        given++;
        controller.enqueue(bytes.slice());
      },
    });
    expect((await fileErrorOf(readSplats(endless, options))).code).toBe('too-large');
    expect(given).toBeLessThan(1000);
  });

  test('a file that ends before the size that it has, while its rows are on their way to the GPU', async () => {
    const bytes = encode(randomRows(100));
    const error = await fileErrorOf(rowsOf(slowFile('a.splat', bytes, [bytes.slice(0, 3000)])));
    expect(error).toMatchObject({ code: 'truncated', message: expect.stringContaining('ends at byte 3000') });
  });

  test('every truncation', async () => {
    const bytes = encode(randomRows(5));
    for (let length = 0; length < bytes.length; length++) {
      for (const chunkBytes of [undefined, 64]) {
        const outcome = await outcomeOf(bytes.slice(0, length), 'a.splat', chunkBytes);
        if (length > 0 && length % 32 === 0) expect(outcome).toMatchObject({ count: length / 32 });
        else expect(outcome).toMatchObject({ code: length === 0 ? 'empty' : 'truncated' });
      }
    }
  });
});
