import { expect, test } from 'vitest';
import type { Harmonics } from '../../../data/packing/harmonics.ts';
import type { SplatSet } from '../../../data/splats/splat-set.ts';
import { paletteSplats } from '../../../testing/palette-splats.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { readSplatPieces, readSplats } from '../../loading/read-splats.ts';
import { encodePly } from '../ply/write-ply.ts';
import { BrickWriter, type BrickWriterOptions } from './brick-writer.ts';
import { memoryFile, type TemporaryFile } from './temporary-files.ts';
import { write } from './write-bricks.ts';

/** Files in memory, and how many of them there are. */
function filesInMemory() {
  const open = new Set<TemporaryFile>();
  const makeFile = async (byteCount: number | undefined) => {
    const file = await memoryFile(byteCount);
    const remove = async () => {
      open.delete(counted);
      await file.remove();
    };
    const counted: TemporaryFile = { ...file, remove };
    open.add(counted);
    return counted;
  };
  return { open, makeFile };
}

async function written(
  add: (writer: BrickWriter) => Promise<void>,
  options: BrickWriterOptions = {},
): Promise<Uint8Array> {
  const { open, makeFile } = filesInMemory();
  const writer = new BrickWriter({ makeFile, ...options });
  const parts: Uint8Array<ArrayBuffer>[] = [];
  const told: number[] = [];
  try {
    await add(writer);
    await writer.finish(
      async (part) => {
        parts.push(part);
      },
      (fraction) => told.push(fraction),
    );
  } finally {
    await writer.end();
  }
  expect(open.size).toBe(0);
  expect(told.at(-1)).toBe(1);
  expect(told).toEqual([...told].sort((a, b) => a - b));
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

function addAll(...sets: SplatSet<Harmonics>[]) {
  return async (writer: BrickWriter) => {
    for (const set of sets) await writer.add(set);
  };
}

/** Without showing both files where they differ, which takes Vitest hours. */
function expectSameBytes(found: Uint8Array, expected: Uint8Array): void {
  expect(found.findIndex((byte, i) => byte !== expected[i])).toBe(-1);
  expect(found.length).toBe(expected.length);
}

/** Most of the splats in a small part of the space, so that buckets are divided again. */
function clumped(count: number): SplatSet {
  const set = randomSplats({ count, shDegree: 1 });
  const positions = set.positions.map((value, i) => {
    const splat = Math.floor(i / 3);
    if (splat % 3 === 0) return value / 500;
    return splat % 3 === 1 ? 0.25 : value;
  });
  return { ...set, positions };
}

test.each([
  ['of one bucket', randomSplats({ count: 5000, shDegree: 2 }), 1 << 18, 1],
  ['of many buckets', randomSplats({ count: 60_000, shDegree: 1 }), 4096, 1],
  ['of buckets that are less than a brick', randomSplats({ count: 20_000, shDegree: 0 }), 700, 4],
  ['in clumps', clumped(40_000), 4096, 4],
  ['far from 0', randomSplats({ count: 20_000, shDegree: 1, origin: [1e6, 0, 0] }), 4096, 4],
  ['with a palette', paletteSplats({ count: 9000, shDegree: 2, entryCount: 50 }), 4096, 3],
])('splats %s make the same file in buckets as in one', async (_, set, bucketSplats, threads) => {
  const expected = await write(set, {});
  expectSameBytes(await written(addAll(set), { bucketSplats, threads }), expected);
});

test('pieces make the same file as all splats of their source', async () => {
  const ply = encodePly(randomSplats({ count: 70_000, shDegree: 1, origin: [5e5, 0, 3e6] }));
  const set = await readSplats(new File([ply], 'a.ply'), { shPrecision: 'f32' });
  const inPieces = await written(
    (writer) =>
      readSplatPieces(new File([ply], 'a.ply'), { shPrecision: 'f32' }, (piece) => writer.add(piece)),
    { bucketSplats: 10_000, threads: 3 },
  );
  expectSameBytes(inPieces, await write(set, {}));
});
