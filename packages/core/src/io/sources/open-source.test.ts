import { createServer, type IncomingMessage, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { gzipSync } from 'node:zlib';
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import { InvalidArgumentError, SplatFileError, SplatSourceError } from '../../data/errors.ts';
import { gltfBytes, gltfOf, splatAttributes } from '../../testing/gltf-fixture.ts';
import { chunked, plyBytes, splatElement } from '../../testing/ply-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { detectFormat } from '../formats/detect.ts';
import { readSplats } from '../loading/read-splats.ts';
import { toPostedError } from '../posted-error.ts';
import { ByteReader } from './byte-reader.ts';
import { knownSource } from './known-source.ts';
import { openSource } from './open-source.ts';
import type { LoadProgress, SplatSource } from './splat-source.ts';

type Opened = Parameters<typeof openSource>[0];

const ply = plyBytes({ format: 'binary_little_endian', elements: [splatElement(100, 1)] });
const scene = gltfOf(splatAttributes(randomSplats({ count: 100, shDegree: 0 })));
const gltf = gltfBytes(scene, 'scene.bin');

const ROUTES: Record<string, (request: IncomingMessage, response: ServerResponse) => void> = {
  '/scene.ply': (_, response) => response.setHeader('content-length', ply.length).end(ply),
  '/zipped.ply': (_, response) => {
    const body = gzipSync(ply);
    response.setHeader('content-encoding', 'gzip').setHeader('content-length', body.length).end(body);
  },
  // A server that packs text tells nothing of its size.
  '/scene.gltf': (_, response) => response.setHeader('content-encoding', 'gzip').end(gzipSync(gltf)),
  '/scene.bin': (_, response) => response.setHeader('content-length', scene.binary.length).end(scene.binary),
  '/page': (_, response) => response.end('<!DOCTYPE html><title>Sign in</title>'),
  '/broken.ply': (_, response) => {
    response.setHeader('content-length', ply.length).write(ply.subarray(0, 1000));
    setTimeout(() => response.destroy(), 10);
  },
  '/stalled.ply': (_, response) => void response.write(ply.subarray(0, 1000)),
  '/silent.ply': () => {},
};

let server: Server;
let base: string;

beforeAll(async () => {
  server = createServer((request, response) => {
    const route = ROUTES[request.url ?? ''];
    if (route) route(request, response);
    else response.writeHead(404).end('nothing here');
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  base = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
});

afterAll(() => {
  server.closeAllConnections();
  server.close();
});

const failure = async (promise: Promise<unknown>): Promise<Error> =>
  promise.then(
    () => expect.fail('should have been rejected'),
    (reason) => reason,
  );

const openBytes = (source: SplatSource, options = {}) => openSource(knownSource(source) as Opened, options);

describe('sources', () => {
  const padded = new Uint8Array(ply.length + 7);
  padded.set(ply, 3);
  const sources: { name: string; make: () => SplatSource; called: string; total: number | undefined }[] = [
    { name: 'ArrayBuffer', make: () => ply.buffer, called: 'buffer', total: ply.length },
    { name: 'Uint8Array', make: () => ply, called: 'buffer', total: ply.length },
    {
      name: 'part of a buffer',
      make: () => padded.subarray(3, 3 + ply.length),
      called: 'buffer',
      total: ply.length,
    },
    {
      name: 'DataView',
      make: () => new DataView(padded.buffer, 3, ply.length),
      called: 'buffer',
      total: ply.length,
    },
    { name: 'Blob', make: () => new Blob([ply]), called: 'blob', total: ply.length },
    { name: 'File', make: () => new File([ply], 'a.ply'), called: 'a.ply', total: ply.length },
    { name: 'stream', make: () => chunked(ply, [999]), called: 'stream', total: undefined },
    {
      name: 'stream with empty chunks',
      make: () => chunked(ply, [0, 10]),
      called: 'stream',
      total: undefined,
    },
  ];
  test.each(sources)('$name', async ({ make, called, total }) => {
    const { name, totalBytes } = await openBytes(make());
    expect({ name, totalBytes }).toEqual({ name: called, totalBytes: total });
    expect((await readSplats(make())).count).toBe(100);
    const error = await failure(openBytes(make(), { signal: AbortSignal.abort(new Error('no more')) }));
    expect(error.message).toBe('no more');
  });

  test('progress of a scene of several addresses is that of all of them, once their sizes are known', async () => {
    const reports: LoadProgress[] = [];
    await readSplats(`${base}/scene.gltf`, { onProgress: (progress) => reports.push(progress) });
    const bytes = gltf.length + scene.binary.length;
    expect(reports.at(-1)).toMatchObject({ loadedBytes: bytes, totalBytes: bytes });
    for (const { totalBytes } of reports) expect([undefined, bytes]).toContain(totalBytes);
  });

  test('the name of an address has no credentials, however long they are', () => {
    const address = `https://me:${'x'.repeat(300)}@example.org/a.ply`;
    expect(knownSource(address).name).toBe('https://example.org/a.ply');
  });

  test('a URL as text and as an object', async () => {
    const reports: LoadProgress[] = [];
    const set = await readSplats(`${base}/scene.ply`, { onProgress: (progress) => reports.push(progress) });
    expect(set).toEqual(await readSplats(ply));
    expect(reports.at(-1)).toMatchObject({
      phase: 'read',
      loadedBytes: ply.length,
      totalBytes: ply.length,
      splats: 100,
    });
    expect((await readSplats(new URL(`${base}/scene.ply`))).count).toBe(100);
  });

  test('the length of a compressed answer is not taken for the size', async () => {
    expect((await openBytes(`${base}/zipped.ply`)).totalBytes).toBeUndefined();
    expect((await readSplats(`${base}/zipped.ply`)).count).toBe(100);
  });

  test('a size that may be that of compressed bytes refuses nothing', async () => {
    const opened = await openBytes(ply);
    const { read } = await import('../formats/ply/read-ply.ts');
    const reports: LoadProgress[] = [];
    const size = { totalBytes: 2000, totalBytesCertain: false };
    const set = await read(
      { ...opened, ...size, reader: new ByteReader(opened) },
      {
        maxBytes: Number.POSITIVE_INFINITY,
        shPrecision: 'u8',
        maxSplats: 100,
        onProgress: (progress) => reports.push(progress),
      },
    );
    expect(set).toMatchObject({ count: 100 });
    expect(reports.at(-1)?.totalBytes).toBeUndefined();
  });
});

describe('failures', () => {
  test('HTTP status', async () => {
    const error = await failure(readSplats(`${base}/missing.ply`));
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error).toMatchObject({ status: 404, file: `${base}/missing.ply`, code: 'unreadable-source' });
    expect(error.message).toContain('the server answered 404 Not Found');
  });

  test.each([
    { name: 'no such host', url: 'http://127.0.0.1:1/a.ply', says: /cannot be fetched/ },
    { name: 'a path in Node', url: 'scenes/garden.ply', says: /outside a page only absolute/ },
    { name: 'a file URL in Node', url: 'file:///a.ply', says: /read a local file yourself/ },
  ])('$name', async ({ url, says }) => {
    const error = await failure(readSplats(url));
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error.message).toMatch(says);
  });

  test('a connection that breaks', async () => {
    const error = await failure(readSplats(`${base}/broken.ply`));
    expect(error).toBeInstanceOf(SplatSourceError);
    expect(error.message).toContain('reading stopped');
  });

  test.each(['/stalled.ply', '/silent.ply'])('abort while %s does not answer', async (path) => {
    const controller = new AbortController();
    setTimeout(() => controller.abort(new Error('changed my mind')), 50);
    const error = await failure(readSplats(base + path, { signal: controller.signal }));
    expect(error.message).toBe('changed my mind');
  });

  /**
   * @fault Files: a stream fails with a value that is no error
   * @consequence `SplatSourceError` that shows the value
   */
  test('streams that cannot be read', async () => {
    const locked = chunked(ply, [100]);
    locked.getReader();
    expect((await failure(openBytes(locked))).message).toMatch(/locked.*Pass a fresh stream/);
    const used = chunked(ply, [100]);
    await new Response(used).arrayBuffer();
    expect(await failure(readSplats(used))).toBeInstanceOf(SplatSourceError);
    const drained = new ReadableStream<Uint8Array>({ start: (controller) => controller.close() });
    expect((await failure(readSplats(drained))).message).toContain('has been read before');
    const failing = new ReadableStream<Uint8Array>({ pull: () => Promise.reject(new Error('disk on fire')) });
    expect((await failure(readSplats(failing))).message).toBe('stream: reading stopped: disk on fire');
    for (const reason of [Object.create(null), { toString: 1 }, Symbol('s'), null]) {
      const odd = new ReadableStream<Uint8Array>({ start: (controller) => controller.error(reason) });
      const error = await failure(readSplats(odd));
      expect(error).toBeInstanceOf(SplatSourceError);
      expect(toPostedError(error)).toMatchObject({
        className: 'SplatSourceError',
        cause: expect.any(String),
      });
    }
    const texts = new ReadableStream({ start: (controller) => controller.enqueue('ply\n') });
    expect((await failure(readSplats(texts))).message).toContain('the stream gave a string');
  });

  test('values that are no source', async () => {
    for (const wrong of [null, undefined, 7, {}, [1, 2]]) {
      expect(await failure(readSplats(wrong as unknown as SplatSource))).toBeInstanceOf(InvalidArgumentError);
    }
    const gone = new ArrayBuffer(8);
    structuredClone(gone, { transfer: [gone] });
    expect((await failure(readSplats(gone))).message).toContain('transferred away');
  });

  test('a stream of no known format is let go of', async () => {
    let isCancelled = false;
    const endless = new ReadableStream<Uint8Array>({
      pull: (controller) => controller.enqueue(new Uint8Array(100)),
      cancel: () => {
        isCancelled = true;
      },
    });
    await failure(readSplats(endless));
    expect(isCancelled).toBe(true);
  });
});

describe('detectFormat', () => {
  const text = (value: string) => Uint8Array.from(value, (character) => character.charCodeAt(0));

  test.each(['ply\n', 'ply\r\n', 'ply \n', 'ply\r'])('%j is a PLY', (start) => {
    expect(detectFormat(text(`${start}format ascii 1.0`)).name).toBe('ply');
  });

  /**
   * @fault Files: a scene of XGRIDS (.lcc), USD, NumPy or PyTorch, a PNG folder of gsplat, 3D Tiles, a
   *   drawing, mesh or scan, as a file or in an archive
   * @consequence `SplatFileError` `unknown-format` with the format's name and how to get a PLY
   */
  test.each([
    { bytes: 'PK\x05\x06', says: /zip archive/ },
    { bytes: '\x28\xb5\x2f\xfd', says: /zstd/ },
    { bytes: '{"asset":{"version":"1.1"},"geometricError":500', says: /3D Tiles/ },
    { bytes: 'version https://git-lfs.github.com/spec/v1', says: /git lfs pull/ },
    { bytes: '\n<!doctype html>', says: /web page/ },
    { bytes: '<?xml version="1.0"?>', says: /web page or XML/ },
    { bytes: ' {"error":"not found"}', says: /JSON/ },
    { bytes: '\x89PNG\r\n', says: /image/ },
    { bytes: '#usda 1.0\n', says: /scene in USD, .* export a PLY/ },
    { bytes: 'PXR-USDC\0\0\0', says: /scene in USD, .* export a PLY/ },
    { bytes: '\x93NUMPY\x01\0', says: /NumPy arrays, .* PLY/ },
    {
      bytes: '{"version":"3.0","name":"XGrids Splats","totalSplats":1000,"totalLevel":3}',
      says: /XGRIDS scene \(\.lcc\), .* export a PLY/,
    },
    { bytes: ' <svg xmlns="http://www.w3.org/2000/svg">', says: /SVG/ },
    { bytes: '<?xml version="1.0"?>\n<!-- a -->\n<svg width="3">', says: /SVG/ },
    { bytes: '# .PCD v.7', says: /point scan/ },
    { bytes: 'b3dm\x01\0\0\0', says: /3D Tiles.* \.glb/ },
    { bytes: 'Kaydara FBX Binary  \0', says: /FBX.*not splats/ },
    { bytes: 'ASTM-E57\x01', says: /E57/ },
    { bytes: '\xef\xbb\xbfply\n', says: /bytes before its "ply"/ },
    { bytes: 'plywood', says: /first bytes \(70 6c 79 77 6f 6f 64\) are of no known format/ },
    { bytes: '\0\0\0\0', says: /\(00 00 00 00\)/ },
  ])('$bytes: $says', ({ bytes, says }) => {
    const detect = () => detectFormat(text(bytes), 'thing.bin');
    expect(detect).toThrow(SplatFileError);
    expect(detect).toThrow(says);
    expect(detect).toThrow(/^thing\.bin: .*Formats read: .*PLY/);
  });

  test('a file without bytes is empty', () => {
    const empty = expect.objectContaining({
      code: 'empty',
      message: expect.stringContaining('file is empty'),
    });
    expect(() => detectFormat(text(''), 'thing.bin')).toThrow(empty);
  });
});
