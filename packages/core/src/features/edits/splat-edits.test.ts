import { describe, expect, test, vi } from 'vitest';
import { InvalidArgumentError } from '../../data/errors.ts';
import { SplatSelection } from '../../data/splats/splat-selection.ts';
import { EDITED, type EditedRows, type EditedValues, SplatEdits } from './splat-edits.data.ts';

const values = (edits: SplatEdits, row: number, column: 'positions' | 'rotations' | 'opacities') => [
  ...edits.valuesOf(row, column),
];

describe('edits', () => {
  test('have a value for each row, or one for all', () => {
    const edits = new SplatEdits();
    edits.set({ first: 1022, count: 4 }, { opacities: [0.1, 0.2, 0.3, 0.4], positions: [1, 2, 3] });
    expect(values(edits, 1023, 'opacities')[0]).toBeCloseTo(0.2, 6);
    expect(values(edits, 1025, 'opacities')[0]).toBeCloseTo(0.4, 6);
    expect(values(edits, 1025, 'positions')).toEqual([1, 2, 3]);
    expect(edits.maskOf(1021)).toBe(0);
    expect(edits.maskOf(1022)).toBe(EDITED.opacities | EDITED.positions);
    expect(edits.maskOf(1e6)).toBe(0);
  });

  test('are refused for rows whose numbers take more than 31 bits', () => {
    const edits = new SplatEdits();
    expect(() => edits.set([2 ** 31], { visible: false })).toThrow('from 0 to 2147483647');
    expect(() => edits.set([2 ** 31 - 1], {})).not.toThrow();
  });

  test('take quaternions as three has them, x, y, z, w', () => {
    const edits = new SplatEdits();
    edits.set([3], { rotations: [1, 2, 3, 4] });
    expect(values(edits, 3, 'rotations')).toEqual([4, 1, 2, 3]);
  });

  test('hide rows and show them, whatever else is edited', () => {
    const edits = new SplatEdits();
    edits.set([1], { opacities: [0.5], visible: false });
    expect(edits.maskOf(1)).toBe(EDITED.opacities | EDITED.hidden);
    edits.set([1], { visible: true });
    expect(edits.maskOf(1)).toBe(EDITED.opacities);
    edits.reset([1]);
    expect(edits.maskOf(1)).toBe(0);
  });

  test('are taken back, of some rows or of all', () => {
    const edits = new SplatEdits(5000);
    edits.set({ first: 0, count: 5000 }, { colors: [1, 1, 1] });
    edits.reset({ first: 0, count: 10 });
    expect([0, 9, 10, 4999].map((row) => edits.maskOf(row))).toEqual([0, 0, EDITED.colors, EDITED.colors]);
    edits.reset();
    expect(edits.maskOf(4999)).toBe(0);
  });

  test('tell those who follow of each change, and of nothing else', () => {
    const edits = new SplatEdits();
    const rowsChanged = vi.fn();
    const end = edits.follow({ rowsChanged });
    const selection = new SplatSelection();
    selection.add([70, 1, 31, 32]);
    edits.set(selection, { colors: [0, 0, 0] });
    expect(rowsChanged).toHaveBeenLastCalledWith(Uint32Array.of(1, 31, 32, 70), EDITED.colors);
    edits.set({ first: 2, count: 3 }, { scales: [1, 2, 3], visible: true });
    expect(rowsChanged).toHaveBeenLastCalledWith({ first: 2, count: 3 }, EDITED.scales | EDITED.hidden);
    expect(edits.hasUnevenScales).toBe(true);
    const { version } = edits;
    edits.set([], { colors: [0, 0, 0] });
    edits.set([1], {});
    expect(edits.version).toBe(version);
    end();
    edits.set([1], { visible: false });
    expect(rowsChanged).toHaveBeenCalledTimes(2);
  });

  test.each<[string, EditedRows, EditedValues, string]>([
    ['rows', [-1], {}, 'rows[0] is -1; rows are whole numbers from 0 to 9.'],
    ['rows', [1, 1.5], {}, 'rows[1] is 1.5; rows are whole numbers from 0 to 9.'],
    ['rows', [10], {}, 'rows[0] is 10; rows are whole numbers from 0 to 9.'],
    [
      'rows',
      { first: 5, count: 6 },
      {},
      '6 rows from 5 on cannot be edited; rows are whole numbers from 0 to 9.',
    ],
    ['positions', [1, 2], { positions: [1, 2, 3, 4] }, 'positions has 4 values; 2 splats need 6, 3 each.'],
    [
      'positions',
      [1, 2],
      { positions: [1, 2, 3, 4, Number.NaN, 6] },
      'positions[4], of splat 1, is NaN; they are finite numbers that float32 holds.',
    ],
    [
      'positions',
      [1],
      { positions: [1e39, 2, 3] },
      'positions[0], of splat 0, is 1e+39; they are finite numbers that float32 holds.',
    ],
    [
      'opacities',
      [1],
      { opacities: [1.5] },
      'opacities[0], of splat 0, is 1.5; they are numbers from 0 to 1.',
    ],
    [
      'scales',
      [1],
      { scales: [1, 0, 1] },
      'scales[1], of splat 0, is 0; they are standard deviations, finite numbers above 0.',
    ],
    [
      'rotations',
      [1],
      { rotations: [0, 0, 0, 0] },
      'rotations[0…3], of splat 0, is 0; a quaternion has a length.',
    ],
    ['visible', [1], { visible: 1 as never }, 'visible is 1; it must be true or false.'],
  ])('refuse wrong %s', (argument, rows, wrong, message) => {
    const edits = new SplatEdits(10);
    const edit = () => edits.set(rows, { colors: [1, 1, 1], ...wrong });
    expect(edit).toThrow(InvalidArgumentError);
    expect(edit).toThrow(expect.objectContaining({ argument, message }));
    expect(edits.version).toBe(0);
    expect(edits.maskOf(1)).toBe(0);
  });

  test('refuse selections of rows that there are not', () => {
    const selection = new SplatSelection();
    selection.add([3, 12]);
    expect(() => new SplatEdits(10).set(selection, { visible: false })).toThrow('Row 12 is selected');
  });
});
