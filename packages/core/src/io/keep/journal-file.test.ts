import { expect, test } from 'vitest';
import type { JournalEntry } from '../formats/bricks/brick-journal.ts';
import { memoryFile } from '../formats/bricks/temporary-files.ts';
import { JournalFile } from './journal-file.ts';

const NO_FLUSH = () => {};

const ENTRIES: readonly JournalEntry[] = [
  {
    kind: 'arrived',
    rows: 70_000,
    runs: [
      {
        at: 2 ** 33,
        run: {
          count: 3,
          words: 14,
          origin: [1e6, -0, 0.1],
          harmonics: { degree: 0, precision: 'u8', wordsPerSplat: 0, bandReach: [Number.POSITIVE_INFINITY] },
        },
      },
    ],
    bounds: [{ min: [-0, -1, -2.5], max: [0, 1, 1 / 3] }],
    told: [null, true],
    sample: Float64Array.of(7, 1e6 + 0.1, -0, 2 ** -40, 0.1),
  },
  { kind: 'divided', depth: 1, first: 12, sizes: [4, 5, 0] },
  {
    kind: 'made',
    range: { first: 12, count: 9 },
    at: 5,
    byteCount: 7,
    made: {
      first: 0,
      sizes: Uint32Array.of(3, 4),
      bounds: Float32Array.of(-0, 1, Number.NaN),
      largestScales: Float32Array.of(),
      errors: Uint16Array.of(1, 65_535, 3),
      fragments: [{ first: 4096, words: Uint32Array.of(2 ** 32 - 1) }],
      samples: Float32Array.of(0.1),
      rounding: {
        splats: 9,
        positions: { count: 1, excess: 1.5, worst: 1e-3, sum: 1.5 },
        float32Positions: { count: 0, excess: 0, worst: 0, sum: 0 },
        scales: { count: 0, excess: 0, worst: 0, sum: 0 },
        colors: { count: 0, excess: 0, worst: 0, sum: 0 },
        harmonics: { values: 0, changes: 0, count: 0 },
      },
    },
  },
];

async function entriesOf(journal: JournalFile): Promise<JournalEntry[]> {
  const entries: JournalEntry[] = [];
  for await (const entry of journal.entries()) entries.push(entry);
  return entries;
}

/** The bytes of a journal with all entries. */
async function journalBytes(): Promise<Uint8Array<ArrayBuffer>> {
  const file = await memoryFile();
  let byteCount = 0;
  const write = async (bytes: Uint8Array<ArrayBuffer>, at: number) => {
    byteCount = at + bytes.length;
    await file.write(bytes, at);
  };
  const journal = new JournalFile({ ...file, write }, 0, NO_FLUSH);
  for (const entry of ENTRIES) await journal.note(entry);
  return file.read(0, byteCount);
}

async function journalOf(bytes: Uint8Array<ArrayBuffer>): Promise<JournalFile> {
  const file = await memoryFile(2 * bytes.length);
  await file.write(bytes, 0);
  return new JournalFile(file, bytes.length, NO_FLUSH);
}

test('entries come back bit by bit', async () => {
  expect(await entriesOf(await journalOf(await journalBytes()))).toEqual(ENTRIES);
});

test('an entry that is not whole, or damaged, is none; the next takes its place', async () => {
  const bytes = await journalBytes();
  const cut = await journalOf(bytes.slice(0, -1));
  expect(await entriesOf(cut)).toEqual(ENTRIES.slice(0, 2));
  const damaged = bytes.slice();
  damaged[bytes.length - 40] ^= 1;
  const journal = await journalOf(damaged);
  expect(await entriesOf(journal)).toEqual(ENTRIES.slice(0, 2));
  expect(await entriesOf(await journalOf(new Uint8Array(0)))).toEqual([]);
});
