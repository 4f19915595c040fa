import { describe, expect, test } from 'vitest';
import { SplatFileError, WebSplatterError } from '../../../errors.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { Choices, fuzz } from '../../../testing/fuzz.ts';
import { plyBytes, splatElement } from '../../../testing/ply-fixture.ts';
import { rowsOf } from '../../../testing/rows-of.ts';
import { sogExample, sogFiles } from '../../../testing/sog-fixture.ts';
import { type ZipOptions, zipBytes } from '../../../testing/zip-fixture.ts';
import { openZipEntry, readZipDirectory } from '../../containers/zip.ts';
import { readSource } from '../../loading/read-source.ts';
import type { LoadProgress, ReadSplatsOptions } from '../../sources/splat-source.ts';
import { ALL_READERS } from '../readers.ts';

const sog = sogFiles(sogExample({ version: 2, count: 7, shDegree: 1, paletteSize: 5 }, new Choices(1)));
const ply = plyBytes({ format: 'binary_little_endian', elements: [splatElement(5)] });
const text = (value: string) => new TextEncoder().encode(value);

const read = (bytes: Uint8Array<ArrayBuffer>, options: ReadSplatsOptions = {}) =>
  readSource(bytes, { name: 'scene.zip', ...options }, ALL_READERS);

const failure = (bytes: Uint8Array<ArrayBuffer>, options?: ReadSplatsOptions) =>
  fileErrorOf(read(bytes, options));

/** A copy of `bytes`, changed. */
function changed(bytes: Uint8Array, change: (view: DataView) => void): Uint8Array<ArrayBuffer> {
  const copy = Uint8Array.from(bytes);
  change(new DataView(copy.buffer));
  return copy;
}

/** Where a record begins, by its signature; the last one of them by default. */
function placeOf(bytes: Uint8Array, signature: number, last = true): number {
  const mark = Uint8Array.of(0x50, 0x4b, signature & 255, signature >> 8);
  return last ? Buffer.from(bytes).lastIndexOf(mark) : Buffer.from(bytes).indexOf(mark);
}
const LOCAL = 0x0403;
const CENTRAL = 0x0201;
const END = 0x0605;

describe('what is read', () => {
  test.each<[string, ZipOptions]>([
    ['stored', {}],
    ['deflated', { isDeflated: true }],
    ['stored as a stream', { hasDescriptors: true }],
    [
      'deflated as a stream, with a comment',
      { isDeflated: true, hasDescriptors: true, comment: 'PK\x05\x06' },
    ],
  ])('SOG and PLY, %s', async (_, options) => {
    expect(await read(zipBytes({ 'scene.ply': ply }, options))).toEqual(await read(ply));
    const rows = await rowsOf(zipBytes(sog, options));
    expect(rows.layout.count).toBe(7);
    expect(rows).toEqual(await rowsOf(zipBytes(sog)));
  });

  test('in folders, beside other files, by backslashes, and with what macOS adds', async () => {
    const files = Object.entries(sog).map(([path, bytes]) => [`a\\scene\\${path}`, bytes] as const);
    const bytes = zipBytes({
      'a/': new Uint8Array(0),
      'a/cameras.json': text('{}'),
      ...Object.fromEntries(files),
      '__MACOSX/a/._other.ply': text('x'),
      'a/._more.ply': text('x'),
    });
    expect(await rowsOf(bytes)).toEqual(await rowsOf(zipBytes(sog)));
    const withPly = zipBytes({
      'scene/Splats.PLY': ply,
      '__MACOSX/scene/._Splats.PLY': text('x'),
      'read.me': text(''),
    });
    expect(await read(withPly)).toEqual(await read(ply));
  });

  test('progress is that of the archive', async () => {
    const bytes = zipBytes(sog);
    const reports: LoadProgress[] = [];
    await read(bytes, { onProgress: (progress) => reports.push(progress) });
    expect(reports.at(-1)).toMatchObject({ loadedBytes: bytes.length, totalBytes: bytes.length, splats: 7 });
  });

  test('it stops when it is told to', async () => {
    const abort = new AbortController();
    const reading = read(zipBytes(sog, { isDeflated: true }), { signal: abort.signal });
    abort.abort(new Error('enough'));
    await expect(reading).rejects.toThrow('enough');
  });
});

describe('what is refused', () => {
  test.each<[string, Record<string, Uint8Array>, RegExp]>([
    ['nothing', { 'a/': new Uint8Array(0) }, /nothing in it/],
    [
      'other files',
      { 'a.obj': text('x'), 'b.txt': text('y') },
      /with a\.obj, b\.txt; read out of archives are SOG, PLY, .*Unpack it/,
    ],
    ['two PLYs', { 'a.ply': ply, 'b/c.ply': ply }, /2 scenes: a\.ply, b\/c\.ply/],
    ['two SOGs', { 'a/meta.json': text('{}'), 'b/meta.json': text('{}') }, /2 scenes/],
    [
      'many files',
      Object.fromEntries(Array.from({ length: 30 }, (_, i) => [`${i}.png`, text('')])),
      /and 22 others/,
    ],
  ])('%s', async (_, files, message) => {
    const error = await failure(zipBytes(files));
    expect(error.code).toBe('unknown-format');
    expect(error.message).toMatch(message);
  });

  test('a scene that lacks a file', async () => {
    const { 'quats.webp': _, ...others } = sog;
    expect(await failure(zipBytes(others))).toMatchObject({
      code: 'missing-part',
      message: expect.stringContaining('quats.webp, which is not in it'),
    });
  });

  test('errors in a file name it', async () => {
    const error = await failure(zipBytes({ 'b/a.ply': text('ply\nformat ascii 1.0\n') }));
    expect(error).toMatchObject({ code: 'bad-header', file: 'scene.zip/b/a.ply' });
  });

  const stored = zipBytes({ 'a.ply': ply });
  const central = placeOf(stored, CENTRAL);
  const end = placeOf(stored, END);
  const most = 0xffffffff;
  test.each<[string, (view: DataView) => void, string, RegExp]>([
    ['another byte', (view) => view.setUint8(central - 1, 0x77), 'damaged', /CRC-32/],
    ['another CRC-32', (view) => view.setUint32(central + 16, 7), 'damaged', /CRC-32/],
    ['an encrypted file', (view) => view.setUint16(central + 8, 1, true), 'unknown-format', /encrypted/],
    ['another method', (view) => view.setUint16(central + 10, 12, true), 'unknown-format', /method 12/],
    ['two sizes', (view) => view.setUint32(central + 24, 9, true), 'damaged', /two sizes/],
    [
      'more bytes than there are',
      (view) => view.setUint32(central + 20, 1e6, true),
      'damaged',
      /does not end where/,
    ],
    ['a place outside', (view) => view.setUint32(central + 42, 1e6, true), 'damaged', /not where/],
    ['a long name', (view) => view.setUint16(central + 28, 60_000, true), 'damaged', /ends within a name/],
    [
      'a directory outside',
      (view) => view.setUint32(end + 16, 1e6, true),
      'damaged',
      /directory lies outside/,
    ],
    [
      'a larger directory',
      (view) => view.setUint32(end + 12, 1e6, true),
      'damaged',
      /directory lies outside/,
    ],
    ['more files', (view) => view.setUint32(end + 8, 0x00020002, true), 'damaged', /2 files, of which 1/],
    ['a second disk', (view) => view.setUint16(end + 4, 1, true), 'unknown-format', /split/],
    ['zip64', (view) => view.setUint32(end + 16, most, true), 'unknown-format', /zip64/],
    ['a zip64 file', (view) => view.setUint32(central + 24, most, true), 'unknown-format', /zip64/],
  ])('%s', async (_, change, code, message) => {
    const error = await failure(changed(stored, change));
    expect(error.code).toBe(code);
    expect(error.message).toMatch(message);
  });

  test('a SOG of which any byte of an image differs', async () => {
    const bytes = zipBytes({ 'meta.json': sog['meta.json'], ...sog });
    const entries = readZipDirectory(bytes, 'scene.zip').filter(({ path }) => path.endsWith('.webp'));
    expect(entries.length).toBe(7);
    for (const { path, start, end } of entries) {
      for (let at = start; at < end; at += at < start + 30 ? 1 : 7) {
        const error = await failure(changed(bytes, (view) => view.setUint8(at, view.getUint8(at) ^ 0x24)));
        expect(error, `${path}, byte ${at - start}`).toMatchObject({
          code: 'damaged',
          message: expect.stringContaining(`${path}: its bytes are not those that were packed`),
        });
      }
    }
  });

  test('deflated bytes that are others, or more than the directory says', async () => {
    const deflated = zipBytes({ 'a.ply': ply }, { isDeflated: true });
    const directory = placeOf(deflated, CENTRAL);
    const crc = changed(deflated, (view) => view.setUint32(directory + 16, 7));
    expect(await failure(crc)).toMatchObject({ code: 'damaged' });
    for (const bytes of [ply.length - 1, ply.length + 1]) {
      const size = changed(deflated, (view) => view.setUint32(directory + 24, bytes, true));
      expect(['damaged', 'truncated']).toContain((await failure(size)).code);
    }
    const data = changed(deflated, (view) => view.setUint32(directory - 40, most));
    expect(await failure(data)).toBeInstanceOf(SplatFileError);
  });

  test('files that share bytes', async () => {
    const bytes = zipBytes({ 'a.png': ply, 'b.ply': ply });
    const second = placeOf(bytes, CENTRAL);
    const error = await failure(changed(bytes, (view) => view.setUint32(second + 42, 0, true)));
    expect(error).toMatchObject({ code: 'damaged', message: expect.stringMatching(/begins within another/) });
  });

  test('two files of one name', async () => {
    const bytes = zipBytes({ 'a.ply': ply, 'b.ply': ply });
    const second = placeOf(bytes, CENTRAL);
    const error = await failure(changed(bytes, (view) => view.setUint8(second + 46, 'a'.charCodeAt(0))));
    expect(error).toMatchObject({ code: 'damaged', message: expect.stringMatching(/two files a.ply/) });
  });

  test('truncated anywhere', async () => {
    for (let length = 4; length < stored.length; length++) {
      const bytes = stored.slice(0, length);
      expect(() => readZipDirectory(bytes, 'scene.zip'), `${length} bytes`).toThrow(/without its last part/);
    }
    expect(await failure(stored.slice(0, 100))).toMatchObject({ code: 'truncated' });
  });

  test('what unpacks to far more than it has bytes', async () => {
    const bytes = zipBytes({ 'a.ply': new Uint8Array(2 ** 20) }, { isDeflated: true });
    const directory = placeOf(bytes, CENTRAL);
    const promising = (size: number) => changed(bytes, (view) => view.setUint32(directory + 24, size, true));
    const error = await failure(promising(80 * 2 ** 20));
    expect(error).toMatchObject({
      code: 'too-large',
      message: expect.stringMatching(/unpacks to 83886080 bytes/),
    });
    const entry = readZipDirectory(promising(5000), 'scene.zip')[0];
    const reader = openZipEntry(promising(5000), entry, 'a.ply').stream.getReader();
    await expect(reader.read()).rejects.toMatchObject({
      code: 'damaged',
      message: expect.stringMatching(/more than its 5000/),
    });
  });

  test('more bytes than are allowed', async () => {
    const bytes = zipBytes({ 'a.ply': new Uint8Array(1000) }, { isDeflated: true });
    expect(await failure(bytes, { maxBytes: 900 })).toMatchObject({ code: 'too-large' });
    expect(await failure(stored, { maxBytes: 100 })).toMatchObject({ code: 'too-large' });
  });

  test('any change gives splats or a typed error', { timeout: 3_600_000 }, async () => {
    const found: Record<string, number> = {};
    const small = sogFiles(sogExample({ version: 2, count: 1, shDegree: 0, width: 1 }, new Choices(2)));
    await fuzz({ few: 300, many: 20_000 }, async (choices) => {
      const isDeflated = choices.isTrue(0.5);
      const bytes = zipBytes(choices.isTrue(0.7) ? { 'a.ply': ply } : small, { isDeflated });
      const directory = placeOf(bytes, CENTRAL, false);
      for (let i = choices.below(3); i >= 0; i--) {
        const from = choices.isTrue(0.7) ? directory : 0;
        bytes[from + choices.below(bytes.length - from)] = choices.of([
          0,
          1,
          8,
          0x7f,
          0xff,
          choices.below(256),
        ]);
      }
      // Else it is no archive.
      bytes.set([0x50, 0x4b, LOCAL & 255, LOCAL >> 8]);
      const outcome = await read(bytes, { maxSplats: 1000 }).catch((error) => error);
      if (outcome instanceof Error && !(outcome instanceof WebSplatterError)) throw outcome;
      const key = outcome instanceof WebSplatterError ? outcome.code : 'splats';
      found[key] = (found[key] ?? 0) + 1;
    });
    expect(Object.keys(found)).toEqual(
      expect.arrayContaining(['splats', 'damaged', 'truncated', 'unknown-format']),
    );
  });
});
