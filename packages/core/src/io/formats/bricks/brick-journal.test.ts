import { expect, test } from 'vitest';
import type { SplatSet } from '../../../data/splats/splat-set.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import type { BrickJournal, JournalEntry } from './brick-journal.ts';
import { type BrickTask, runTask } from './brick-tasks.ts';
import { BrickWriter } from './brick-writer.ts';
import { sliceOf } from './slice-set.ts';
import { type MakeTemporaryFile, memoryFile, type TemporaryFile } from './temporary-files.ts';
import { write } from './write-bricks.ts';

/** Splats of a bucket, and of a piece that is added. */
const PART_SPLATS = 1500;

/** Writes and notes of a bucket, and some more. */
const LEAST_POWER = 6;

/** Storage of which files with names, and a journal, outlast writers. */
class Disk {
  readonly entries: JournalEntry[] = [];
  readonly #named = new Map<string, TemporaryFile>();

  /** For a writer, until the power goes off after so many writes and notes. */
  storage(most: number): { makeFile: MakeTemporaryFile; journal: BrickJournal } {
    let left = most;
    const count = () => {
      if (left-- <= 0) throw new Error('the power is off');
    };
    const makeFile: MakeTemporaryFile = async (byteCount, name) => {
      const known = name === undefined ? undefined : this.#named.get(name);
      const file = known ?? (await memoryFile(byteCount));
      if (name !== undefined) this.#named.set(name, file);
      return {
        read: file.read,
        write: async (bytes, at) => {
          count();
          await file.write(bytes, at);
        },
        remove: async () => {
          count();
          if (name !== undefined) this.#named.delete(name);
          await file.remove();
        },
      };
    };
    const { entries } = this;
    const journal: BrickJournal = {
      entries: async function* () {
        yield* structuredClone(entries);
      },
      note: async (entry) => {
        count();
        entries.push(structuredClone(entry));
      },
    };
    return { makeFile, journal };
  }
}

test.each([
  ['at once', 1],
  ['with threads', 3],
])('work that ends again and again goes on to the same file, %s', async (_, threads) => {
  const set = clumped(7500);
  const expected = await write(set, {});
  const disk = new Disk();
  let tasks = 0;
  const run = async (task: BrickTask) => {
    if (task.kind === 'splats') tasks++;
    // Others begin meanwhile.
    await new Promise((resolve) => setImmediate(resolve));
    return runTask(task);
  };
  let [added, ends] = [0, 0];
  /** So little that no two buckets are done at once, unless something takes more. */
  let power = LEAST_POWER;
  for (;;) {
    const noted = disk.entries.length;
    const writer = new BrickWriter({ ...disk.storage(power), run, threads, bucketSplats: PART_SPLATS });
    try {
      for (let row = await writer.resume(); row < set.count; row += PART_SPLATS) {
        await writer.add(sliceOf(set, row, Math.min(set.count, row + PART_SPLATS)));
        await writer.keep(Math.min(set.count, row + PART_SPLATS));
        added++;
      }
      expect(writer.count).toBe(set.count);
      const parts: Uint8Array<ArrayBuffer>[] = [];
      await writer.finish(async (part) => {
        parts.push(part);
      });
      expect(new Uint8Array(await new Blob(parts).arrayBuffer())).toEqual(expected);
      break;
    } catch (error) {
      if ((error as Error).message !== 'the power is off') throw error;
      expect(++ends).toBeLessThan(200);
      power = disk.entries.length > noted ? LEAST_POWER : power + 3;
    }
  }
  expect(ends).toBeGreaterThan(5);
  expect(added).toBe(set.count / PART_SPLATS);
  expect(disk.entries.filter(({ kind }) => kind === 'divided').length).toBeGreaterThan(1);
  // What was under way when the work ended is done again, and nothing else.
  const made = disk.entries.filter(({ kind }) => kind === 'made').length;
  expect(tasks - made).toBeLessThanOrEqual(ends * (threads + 1));
});

/** Most of the splats in a small part of the space, so that buckets are divided again. */
function clumped(count: number): SplatSet {
  const set = randomSplats({ count, shDegree: 0 });
  return { ...set, positions: set.positions.map((value, i) => (i % 9 < 6 ? 0.3 + value / 500 : value)) };
}
