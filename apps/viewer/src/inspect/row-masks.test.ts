import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { RowMasks } from '../state/selecting.ts';
import { countOf } from '../state/selecting.ts';
import { joined, selectedWith, selectionOf, without } from './row-masks.ts';

const rowsOf = (masks: RowMasks) =>
  new Set(
    [...masks].flatMap(([key, words]) =>
      Array.from({ length: 32 * words.length }, (_, row) => row)
        .filter((row) => (words[row >>> 5] >>> (row & 31)) & 1)
        .map((row) => `${key}:${row}`),
    ),
  );
const union = (a: Set<string>, b: Set<string>) => new Set([...a, ...b]);
const difference = (a: Set<string>, b: Set<string>) => new Set([...a].filter((row) => !b.has(row)));
/** None without a row, as in the store. */
const masks = fc
  .dictionary(fc.constantFrom('1/0', '2/0', '2/1'), fc.uint32Array({ maxLength: 3 }))
  .map((words) => without(new Map(Object.entries(words)) as RowMasks, new Map()));

describe('masks of rows', () => {
  it('are joined and taken from each other as sets of rows are', () => {
    fc.assert(
      fc.property(masks, masks, (a, b) => {
        const before = [rowsOf(a), rowsOf(b)];
        expect(rowsOf(joined(a, b))).toEqual(union(before[0], before[1]));
        const left = without(a, b);
        expect(rowsOf(left)).toEqual(difference(before[0], before[1]));
        expect([...left.values()].every((words) => words.some((word) => word !== 0))).toBe(true);
        expect([rowsOf(a), rowsOf(b)]).toEqual(before);
        expect(countOf(a)).toBe(before[0].size);
      }),
    );
  });

  it('select anew, more or fewer, but nothing that is removed', () => {
    fc.assert(
      fc.property(masks, masks, masks, (some, removed, found) => {
        const edit = { selected: without(some, removed), removed };
        const [before, gone, now] = [edit.selected, removed, found].map(rowsOf);
        const expected = {
          replace: difference(now, gone),
          add: union(before, difference(now, gone)),
          subtract: difference(before, now),
        };
        for (const mode of ['replace', 'add', 'subtract'] as const)
          expect(rowsOf(selectedWith(mode, edit, found))).toEqual(expected[mode]);
      }),
    );
  });

  it('are one selection each for the engine', () => {
    const words = Uint32Array.of(5);
    expect(selectionOf(words)).toBe(selectionOf(words));
    expect(selectionOf(words).has(2)).toBe(true);
  });
});
