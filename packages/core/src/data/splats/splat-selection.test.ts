import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../errors.ts';
import { SplatSelection } from './splat-selection.ts';

const rows = fc.array(fc.nat(300));
const steps = fc.array(fc.record({ what: fc.constantFrom('add', 'delete', 'toggle'), rows }));

describe('a selection', () => {
  test('has the rows that a set of numbers has', () => {
    fc.assert(
      fc.property(steps, rows, (changes, asked) => {
        const selection = new SplatSelection();
        const reference = new Set<number>();
        for (const { what, rows } of changes) {
          selection[what](rows);
          for (const row of new Set(rows))
            reference[what === 'toggle' ? (reference.has(row) ? 'delete' : 'add') : what](row);
        }
        expect(selection.size).toBe(reference.size);
        expect([...selection]).toEqual([...reference].sort((a, b) => a - b));
        for (const row of asked) expect(selection.has(row)).toBe(reference.has(row));
        const bits = selection.bitsOf(Uint32Array.from(asked));
        expect(bits.length).toBe(Math.ceil(asked.length / 32));
        for (const [i, row] of asked.entries())
          expect((bits[Math.floor(i / 32)] >>> (i % 32)) & 1).toBe(reference.has(row) ? 1 : 0);
      }),
    );
  });

  test('takes all rows at once as bits, of which it keeps a copy', () => {
    fc.assert(
      fc.property(fc.uint32Array({ maxLength: 5 }), (words) => {
        const selection = new SplatSelection();
        selection.add([7, 500]);
        const { version } = selection;
        selection.setWords(words);
        const rows = Array.from({ length: 32 * words.length }, (_, row) => row);
        const selected = rows.filter((row) => (words[Math.floor(row / 32)] >>> (row % 32)) & 1);
        expect(selection.size).toBe(selected.length);
        expect(selection.version).not.toBe(version);
        expect(rows.filter((row) => selection.has(row))).toEqual(selected);
        expect(selection.has(500)).toBe(false);
        const before = words.slice();
        selection.add([0]);
        expect(words).toEqual(before);
      }),
    );
  });

  test('has another version after every change, and only then', () => {
    const selection = new SplatSelection();
    const versions = [selection.version];
    const change = (changing: () => void) => {
      changing();
      versions.push(selection.version);
    };
    change(() => selection.add([3, 40, 3]));
    change(() => selection.delete([40]));
    change(() => selection.toggle([3, 4]));
    change(() => selection.clear());
    expect(new Set(versions).size).toBe(5);
    const { version } = selection;
    selection.clear();
    selection.add([]);
    selection.delete([3, 1000]);
    selection.toggle([]);
    expect(selection.version).toBe(version);
    expect(selection.size).toBe(0);
  });

  for (const row of [-1, 0.5, Number.NaN, 2 ** 31])
    test(`refuses row ${row}, and stays as it was`, () => {
      const selection = new SplatSelection();
      selection.add([1]);
      expect(() => selection.add([2, row])).toThrow(InvalidArgumentError);
      expect(() => selection.delete([1, row])).toThrow(/rows are whole numbers/);
      expect(() => selection.toggle([1, row])).toThrow(/rows are whole numbers/);
      expect([selection.has(1), selection.has(2), selection.size]).toEqual([true, false, 1]);
    });
});
