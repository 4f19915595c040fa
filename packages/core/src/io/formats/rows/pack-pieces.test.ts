import { expect, test } from 'vitest';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { Turns } from '../../../data/turns.ts';
import { seededRandom } from '../../../testing/seeded-random.ts';
import { LEFT_OUT, packPieces } from './pack-pieces.ts';

const row = new Float64Array(ROW_SLOT.harmonics);

/** Splats at random places, whose harmonics are their row index. */
function fillWith(change: (i: number) => number | undefined) {
  const random = seededRandom(4);
  return (i: number, words: Uint32Array, wordOffset: number) => {
    for (let slot = 0; slot < row.length; slot++) row[slot] = random() - 0.5;
    words[wordOffset] = 10 + i;
    return change(i) ?? 10 + i;
  };
}

test('splats are packed in full chunks, each with its row and its harmonics', async () => {
  const fill = fillWith((i) => {
    if (i === 3) row[ROW_SLOT.opacity] = Number.NaN;
    return i === 5 ? LEFT_OUT : undefined;
  });
  const pieces = await packPieces(5000, 1, row, fill, new Turns(undefined));
  expect(pieces.map(({ cells }) => cells.map(({ leafCount }) => leafCount))).toEqual([
    [...Array(15).fill(256), 254],
    [256, 256, 256, 136],
  ]);
  const rows = pieces.flatMap(({ fileIndices: rows, harmonics, cells }) => {
    const count = cells.reduce((sum, { leafCount }) => sum + leafCount, 0);
    const words = harmonics.length / rows.length;
    for (let i = 0; i < count; i++) expect(harmonics[words * i]).toBe(rows[i]);
    return [...rows.subarray(0, count)];
  });
  const expected = Array.from({ length: 5000 }, (_, i) => 10 + i).filter(
    (each) => each !== 13 && each !== 15,
  );
  expect(rows.toSorted((a, b) => a - b)).toEqual(expected);
});

test('none are packed of a signal that has aborted', async () => {
  const turns = new Turns(AbortSignal.abort('enough'));
  await expect(
    packPieces(
      300,
      0,
      row,
      fillWith(() => undefined),
      turns,
    ),
  ).rejects.toBe('enough');
});
