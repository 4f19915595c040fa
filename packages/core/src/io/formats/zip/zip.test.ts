import { describe, expect, test } from 'vitest';
import { SplatFileError } from '../../../data/errors.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { Choices } from '../../../testing/fuzz.ts';
import { plyBytes, splatElement } from '../../../testing/ply-fixture.ts';
import { rowsOf } from '../../../testing/rows-of.ts';
import { sogExample, sogFiles } from '../../../testing/sog-fixture.ts';
import { type ZipOptions, zipBytes } from '../../../testing/zip-fixture.ts';
import { openZipEntry, readZipDirectory } from '../../containers/zip.ts';
import { readSource } from '../../loading/read-source.ts';
import { knownSource } from '../../sources/known-source.ts';
import type { LoadProgress, ReadSplatsOptions } from '../../sources/splat-source.ts';
import { ALL_READERS } from '../readers.ts';

const sog = sogFiles(sogExample({ version: 2, count: 7, shDegree: 1, paletteSize: 5 }, new Choices(1)));
const ply = plyBytes({ format: 'binary_little_endian', elements: [splatElement(5)] });
const text = (value: string) => new TextEncoder().encode(value);

const read = (bytes: Uint8Array<ArrayBuffer>, options: ReadSplatsOptions = {}) =>
  readSource(knownSource(bytes, { name: 'scene.zip', ...options }), options, ALL_READERS);

const failure = (bytes: Uint8Array<ArrayBuffer>, options?: ReadSplatsOptions) =>
  fileErrorOf(read(bytes, options));

/** A copy of `bytes`, changed. */
function changed(bytes: Uint8Array, change: (view: DataView) => void): Uint8Array<ArrayBuffer> {
  const copy = Uint8Array.from(bytes);
  change(new DataView(copy.buffer));
  return copy;
}

/** Where the last record with a signature begins. */
function placeOf(bytes: Uint8Array, signature: number): number {
  const mark = Uint8Array.of(0x50, 0x4b, signature & 255, signature >> 8);
  return Buffer.from(bytes).lastIndexOf(mark);
}
const CENTRAL = 0x0201;
const END = 0x0605;
const END64 = 0x0606;
const LOCATOR64 = 0x0706;

describe('reads', () => {
  test.each<[string, ZipOptions]>([
    ['stored', {}],
    ['deflated', { isDeflated: true }],
    ['stored as a stream', { hasDescriptors: true }],
    [
      'deflated as a stream, with a comment',
      { isDeflated: true, hasDescriptors: true, comment: 'PK\x05\x06' },
    ],
    ['stored, with numbers of zip64', { isZip64: true }],
    ['deflated, with numbers of zip64', { isZip64: true, isDeflated: true }],
    [
      'deflated as a stream, with numbers of zip64 and a comment',
      { isZip64: true, isDeflated: true, hasDescriptors: true, comment: 'PK\x06\x07' },
    ],
  ])('SOG and PLY, %s', async (_, options) => {
    expect(await read(zipBytes({ 'scene.ply': ply }, options))).toEqual(await read(ply));
    const rows = await rowsOf(zipBytes(sog, options));
    expect(rows.layout.count).toBe(7);
    expect(rows).toEqual(await rowsOf(zipBytes(sog)));
  });

  /**
   * @fault Files: an archive with a network that moves the splats of its PLY (4D Gaussians)
   * @consequence the still scene is shown, and `fileFacts.notes` says so
   */
  test.each(['out/deformation.pth', 'deform/iteration_40000/deform.pth', 'deformation_table.pt'])(
    'PLY beside %s, with a note that its splats are still',
    async (network) => {
      const bytes = zipBytes({ 'out/point_cloud.ply': ply, [network]: text('x') });
      const still = expect.stringMatching(
        /still splats are shown: deform.*\.pth?, which moves them, is not read/,
      );
      expect((await rowsOf(bytes)).layout.fileFacts?.notes).toEqual([still]);
      const { fileFacts, ...set } = await read(bytes);
      expect(fileFacts!.notes).toEqual([still]);
      const { fileFacts: own, ...plain } = await read(ply);
      expect(own!.notes).toBeUndefined();
      expect(set).toEqual(plain);
    },
  );

  test('in folders, beside other files, by backslashes, and with additions by macOS', async () => {
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

  test.each([false, true])(
    'of a zip64 archive: only numbers that do not fit elsewhere have 64 bits (%s)',
    async (isZip64) => {
      const bytes = zipBytes({ 'scene.ply': ply }, { isZip64: true });
      const [directory, end] = [placeOf(bytes, CENTRAL), placeOf(bytes, END)];
      const end64 = placeOf(bytes, END64);
      const { start, unpackedBytes } = readZipDirectory(bytes, 'scene.zip')[0];
      const told = changed(bytes, (view) => {
        if (isZip64) return;
        // As Go writes them: sizes in 64 bits, and the place too, though it fits into 32.
        view.setUint32(directory + 42, 0, true);
        view.setUint16(end + 8, 1, true);
        view.setUint16(end + 10, 1, true);
        view.setUint32(end + 16, Number(view.getBigUint64(end64 + 48, true)), true);
        view.setBigUint64(end64 + 32, 7n, true);
      });
      expect(readZipDirectory(told, 'scene.zip')).toMatchObject([
        { path: 'scene.ply', start, unpackedBytes },
      ]);
      expect(await read(told)).toEqual(await read(ply));
    },
  );

  test.each([
    ['zip64', 70_000, true],
    ['an old program, which cannot have more', 0xffff, false],
  ])('of %s, with very many files beside the scene', async (_, count, isZip64) => {
    const names = Array.from({ length: count - 1 }, (_, i) => `${i}.txt`);
    const files = Object.fromEntries(names.map((name) => [name, new Uint8Array(0)]));
    const bytes = zipBytes({ ...files, 'scene.ply': ply }, { isZip64 });
    expect(readZipDirectory(bytes, 'scene.zip')).toHaveLength(count);
    expect(await read(bytes)).toEqual(await read(ply));
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

describe('refuses', () => {
  test.each<[string, Record<string, Uint8Array>, RegExp]>([
    ['nothing', { 'a/': new Uint8Array(0) }, /nothing in it/],
    [
      'other files',
      { 'a.obj': text('x'), 'b.txt': text('y') },
      /with a\.obj, b\.txt; only SOG, PLY, .*Unpack it/,
    ],
    ['two PLYs', { 'a.ply': ply, 'b/c.ply': ply }, /2 scenes; .*: a\.ply, b\/c\.ply/],
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
    ['a directory in zip64', (view) => view.setUint32(end + 16, most, true), 'damaged', /lies outside/],
    ['a file in zip64', (view) => view.setUint32(central + 24, most, true), 'damaged', /lacks .* zip64/],
  ])('%s', async (_, change, code, message) => {
    const error = await failure(changed(stored, change));
    expect(error.code).toBe(code);
    expect(error.message).toMatch(message);
  });

  const zip64 = zipBytes({ 'a.ply': ply }, { isZip64: true });
  const entry64 = placeOf(zip64, CENTRAL);
  const [end64, locator64] = [placeOf(zip64, END64), placeOf(zip64, LOCATOR64)];
  /** After the name and a field of 9 bytes: sizes and place, behind their field's first 4 bytes. */
  const field64 = entry64 + 46 + 'a.ply'.length + 9;
  const places64: readonly [string, number, bigint, string, RegExp][] = [
    ['more bytes', field64 + 4, 2n ** 33n, 'damaged', /two sizes/],
    ['more bytes than there are', field64 + 12, 2n ** 33n, 'damaged', /does not end where/],
    ['a place outside', field64 + 20, 2n ** 33n, 'damaged', /not where/],
    ['a place beyond all', field64 + 20, 2n ** 64n - 1n, 'damaged', /not where/],
    ['more files', end64 + 32, 2n ** 63n, 'unknown-format', /split/],
    ['a directory outside', end64 + 48, 2n ** 33n, 'damaged', /directory lies outside/],
    ['a larger directory', end64 + 40, 2n ** 64n - 1n, 'damaged', /directory lies outside/],
    ['its record elsewhere', locator64 + 8, 1n, 'damaged', /zip64 record is not where/],
    ['its record outside', locator64 + 8, 2n ** 64n - 1n, 'damaged', /zip64 record is not where/],
  ];
  test.each(places64)('in a zip64 archive, %s', async (_, at, value, code, message) => {
    const error = await failure(changed(zip64, (view) => view.setBigUint64(at, value, true)));
    expect(error.code).toBe(code);
    expect(error.message).toMatch(message);
  });

  test.each<[string, (view: DataView) => void, string, RegExp]>([
    ['another field instead', (view) => view.setUint16(field64, 2, true), 'damaged', /lacks .* zip64/],
    ['a short field', (view) => view.setUint16(field64 + 2, 16, true), 'damaged', /lacks .* zip64/],
    ['a long field', (view) => view.setUint16(field64 + 2, 999, true), 'damaged', /lacks .* zip64/],
    [
      'fields that are too long',
      (view) => view.setUint16(entry64 + 30, 999, true),
      'damaged',
      /ends within a.ply/,
    ],
  ])('in a zip64 archive, %s', async (_, change, code, message) => {
    const error = await failure(changed(zip64, change));
    expect(error.code).toBe(code);
    expect(error.message).toMatch(message);
  });

  test('a disk of a split zip64 archive', async () => {
    const bytes = changed(zip64, (view) => {
      view.setUint16(placeOf(zip64, END) + 4, 0xffff, true);
      view.setUint32(end64 + 16, 70_000, true);
    });
    expect(await failure(bytes)).toMatchObject({
      code: 'unknown-format',
      message: expect.stringMatching(/split/),
    });
  });

  test('files that unpack to 4 GiB less than their zip64 archive says', async () => {
    const deflated = zipBytes({ 'a.ply': ply }, { isZip64: true, isDeflated: true });
    const field = placeOf(deflated, CENTRAL) + 46 + 'a.ply'.length + 9;
    const size = BigInt(ply.length) + 2n ** 32n;
    const bytes = changed(deflated, (view) => view.setBigUint64(field + 4, size, true));
    expect(await failure(bytes)).toMatchObject({ code: 'too-large' });
    expect(await failure(bytes, { maxBytes: 2 ** 40 })).toMatchObject({ code: 'damaged' });
  });

  test('a SOG of which any byte of an image differs', async () => {
    const bytes = zipBytes({ 'meta.json': sog['meta.json'], ...sog });
    const entries = readZipDirectory(bytes, 'scene.zip').filter(({ path }) => path.endsWith('.webp'));
    expect(entries.length).toBe(7);
    for (const { path, start, end } of entries) {
      for (let at = start; at < end; at += at < start + 30 ? 1 : 53) {
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

  test('files that unpack to far more than their bytes', async () => {
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
});

/**
 * @fault Files: a scene of XGRIDS (.lcc), USD, NumPy or PyTorch, a PNG folder of gsplat, 3D Tiles, a
 *   drawing, mesh or scan, as a file or in an archive
 */
test.each([
  [/scene in USD, which is not read; export a PLY/, ['scene.usdc', 'textures/0.png']],
  [/NumPy arrays/, ['means.npy', 'scales.npy']],
  [/PyTorch checkpoint.* export a PLY/, ['archive/data.pkl', 'archive/data/0', 'archive/version']],
  [/XGRIDS .* export a PLY/, ['scan/scan.lcc', 'scan/data.bin', 'scan/index.bin']],
])('archives of scenes that are not read say how to get a PLY: %s', async (message, names) => {
  const error = await failure(zipBytes(Object.fromEntries(names.map((name) => [name, text('x')]))));
  expect(error.message).toMatch(message);
  expect(error.message).not.toContain('Unpack');
  expect(error.code).toBe('unknown-format');
});
