import { expect, test } from 'vitest';
import { CellMerger, emptyLeaf } from '../../../data/bricks/cell-merger.ts';
import { SplatSourceError, WebSplatterError } from '../../../data/errors.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { BrickWriter } from './brick-writer.ts';
import { isOfStorage, memoryFile, type TemporaryFile } from './temporary-files.ts';

const SET = randomSplats({ count: 4500, seed: 3, shDegree: 1 });

type Read = (bytes: Uint8Array<ArrayBuffer>) => Uint8Array<ArrayBuffer>;

/** Writes SET in buckets of few splats, over storage whose reads of files of that name `change`. */
async function writeOver(change: Read, named: RegExp): Promise<Uint8Array> {
  const makeFile = async (byteCount?: number, name = ''): Promise<TemporaryFile> => {
    const file = await memoryFile(byteCount);
    if (!named.test(name)) return file;
    return { ...file, read: async (at, count) => change(await file.read(at, count)) };
  };
  const writer = new BrickWriter({ makeFile, bucketSplats: 2048 });
  try {
    await writer.add(SET);
    const parts: Uint8Array[] = [];
    await writer.finish(async (part) => {
      parts.push(part);
    });
    return Buffer.concat(parts);
  } finally {
    await writer.end();
  }
}

/**
 * @fault Files: storage of a `BrickWriter` gives zeros, too few bytes, or other bytes than were written
 * @consequence `SplatSourceError`; the writing ends
 */
test.each<[string, Read]>([
  ['zeros', (bytes) => bytes.fill(0)],
  ['nothing', () => new Uint8Array(0)],
  ['half of it', (bytes) => bytes.slice(0, bytes.length / 2)],
  ['ones', (bytes) => bytes.fill(255)],
  ['another byte', (bytes) => bytes.fill(bytes[5] ^ 1, 5, 6)],
  ['null', () => null as never],
])('storage that reads %s is an error that says so', async (_, change) => {
  for (const named of [/^arrived/, /^buckets/, /^bricks/, /^roots/, /./])
    await expect(writeOver(change, named), String(named)).rejects.toThrow(SplatSourceError);
});

test('storage that contradicts a journal is told from a source that fails', async () => {
  const wrong = await writeOver((bytes) => bytes.fill(0), /./).catch((error) => error);
  const journal = await new BrickWriter({
    journal: {
      entries: async function* () {
        yield {} as never;
      },
      note: async () => {},
    },
  })
    .resume()
    .catch((error) => error);
  for (const error of [wrong, journal, new RangeError()]) expect(isOfStorage(error), error).toBe(true);
  const source = new SplatSourceError('a.ply', 'it cannot be read');
  const worker = new WebSplatterError('worker-failed', 'a worker stopped');
  for (const error of [source, worker]) expect(isOfStorage(error), error.message).toBe(false);
});

test('storage may give a part of other memory', async () => {
  const within: Read = (bytes) => {
    const larger = new Uint8Array(bytes.length + 3);
    larger.set(bytes, 1);
    return larger.subarray(1, 1 + bytes.length);
  };
  expect(await writeOver(within, /./)).toEqual(await writeOver((bytes) => bytes, /./));
});

test('splats whose costs are no numbers are merged, too', () => {
  const merger = new CellMerger();
  const leaf = emptyLeaf();
  leaf.position.fill(Number.NaN);
  merger.begin();
  for (let i = 0; i < 100; i++) merger.add(leaf, 0);
  expect(merger.merge()).toBe(16);
});
