import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { gzipSync } from 'node:zlib';
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../data/errors.ts';
import { plyBytes, splatElement } from '../../testing/ply-fixture.ts';
import { zipBytes } from '../../testing/zip-fixture.ts';
import { SPLAT_FORMATS } from '../formats/formats.ts';
import type { ReadSplatsOptions, SplatSource } from '../sources/splat-source.ts';
import { loadSplats } from './load-splats.ts';
import { readSplatPieces, readSplats } from './read-splats.ts';

/** Two splats of 32 bytes, which nothing but a name tells. */
const splat = new Uint8Array(64);
for (const row of [0, 1]) {
  new Float32Array(splat.buffer, 32 * row, 6).set([row, 0.5, -1, 0.1, 0.2, 0.3]);
  splat.set([200, 100, 50, 255, 255, 128, 128, 128], 32 * row + 24);
}
const ply = plyBytes({ format: 'binary_little_endian', elements: [splatElement(3)] });

let server: Server;
let base: string;
beforeAll(async () => {
  server = createServer((request, response) => {
    const { pathname, searchParams } = new URL(request.url!, 'http://localhost');
    const disposition = searchParams.get('disposition');
    if (disposition) response.setHeader('content-disposition', disposition);
    if (pathname.endsWith('.gz')) response.setHeader('content-encoding', 'gzip').end(gzipSync(splat));
    else if (pathname === '/moved') response.writeHead(302, { location: '/files/scene.splat' }).end();
    else response.end(pathname === '/packed' ? gzipSync(splat) : splat);
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  base = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
});
afterAll(() => server.close());

const stream = () => new Blob([splat]).stream();
/** A source of each kind, none of which has a name that tells its format. */
const SOURCES: Readonly<Record<string, () => SplatSource>> = {
  'an address': () => `${base}/api/files/17`,
  'an address that ends otherwise': () => new URL(`${base}/download.php?file=scene.splat`),
  'an object URL': () => URL.createObjectURL(new Blob([splat])),
  'a data URL': () => `data:application/octet-stream;base64,${Buffer.from(splat).toString('base64')}`,
  'a Blob': () => new Blob([splat]),
  'a File of another name': () => new File([splat], 'scene.bin'),
  files: () => ({ files: [new File([splat], 'scene.bin')] }),
  'a buffer': () => splat.slice().buffer,
  'a view': () => splat,
  'a stream': stream,
  'a stream of gzip': () => new Blob([gzipSync(splat)]).stream(),
  'a zip': () => zipBytes({ 'scene.splat': splat }),
};

describe.each(Object.keys(SOURCES))('%s', (kind) => {
  const source = SOURCES[kind];

  /**
   * @fault Files: neither first bytes nor URL give the format, as for a `.splat` from an API
   * @consequence `format`, `name` or `Content-Disposition` decides, for every kind of source; else the
   *   error says so
   */
  test.each<ReadSplatsOptions>([
    { format: 'splat' },
    { name: 'scene.splat' },
    { name: 'shop/scene.SPLAT', format: undefined },
    { name: 'My scene', format: 'splat' },
  ])('is a .splat by %j', async (options) => {
    const expected = { count: 2, fileFacts: { format: 'splat' } };
    expect(await readSplats(source(), options)).toMatchObject(expected);
    const { facts, ...cloud } = await loadSplats(source(), options);
    expect({ count: cloud.count, fileFacts: facts.fileFacts }).toMatchObject(expected);
    let count = 0;
    await readSplatPieces(source(), options, async (piece) => {
      count += piece.count;
    });
    expect(count).toBe(2);
  });

  test.runIf(kind !== 'a zip')('is of no known format without that', async () => {
    const reading = readSplats(source());
    await expect(reading).rejects.toMatchObject({ code: 'unknown-format' });
  });
});

test('what first bytes tell counts for more than a format and names', async () => {
  for (const options of [{ format: 'splat' }, { name: 'scene.splat' }, { format: 'gzip' }] as const)
    expect(await readSplats(ply, options)).toMatchObject({ count: 3, fileFacts: { format: 'ply' } });
});

test('a name without an end leaves the format to the source’s own', async () => {
  const own = [`${base}/files/scene.splat?token=1#top`, new File([splat], 'folder/scene.splat')];
  for (const source of own)
    for (const name of ['My scene', 'Room No.5', ''])
      expect((await readSplats(source, { name })).count).toBe(2);
});

test('a server’s Content-Disposition tells the format, and an address that it leads to', async () => {
  const named = (disposition: string, path = 'api/17') =>
    readSplats(`${base}/${path}?disposition=${encodeURIComponent(disposition)}`);
  for (const disposition of [
    'attachment; filename="scene.splat"',
    "attachment; filename*=UTF-8''sz%C3%A8ne.splat",
    'inline; filename=C:\\scenes\\a.splat',
  ])
    expect(await named(disposition)).toMatchObject({ count: 2, fileFacts: { format: 'splat' } });
  expect(await named('attachment; filename="scene.splat.gz"', 'packed')).toMatchObject({ count: 2 });
  await expect(named('attachment; filename="scene.bin"')).rejects.toThrow("format 'splat'");
  expect((await readSplats(`${base}/moved`)).count).toBe(2);
});

test('a .splat.gz that is unpacked on the way is a .splat', async () => {
  const expected = { count: 2, fileFacts: { format: 'splat' } };
  expect(await readSplats(`${base}/files/scene.splat.gz`)).toMatchObject(expected);
  expect((await loadSplats(`${base}/files/scene.splat.gz`)).count).toBe(2);
  expect(await readSplats(new File([gzipSync(splat)], 'scene.splat.gz'))).toMatchObject(expected);
});

test('formats are those that are read, by their names', async () => {
  const unknown = await readSplats(splat, { format: 'obj' as never }).catch((error) => error);
  expect(unknown).toBeInstanceOf(InvalidArgumentError);
  expect(unknown.argument).toBe('format');
  for (const { name } of SPLAT_FORMATS) {
    expect(unknown.message).toContain(name);
    await expect(readSplats(ply, { format: name as never })).resolves.toMatchObject({ count: 3 });
  }
  await expect(loadSplats(splat, { format: 'obj' as never })).rejects.toThrow('format is obj');
});
