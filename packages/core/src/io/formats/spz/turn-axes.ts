import { ROW_SLOT } from '../../../data/splats/splat-row.ts';

/** Bit flags of a coordinate system's number minus one. */
const IS_RIGHT = 1;
const IS_UP = 2;
const IS_FRONT = 4;
/** The axes equal the system of the other bits after (x, y, z) -> (x, -z, y). */
const IS_Z_UP = 8;
/** Right, down, front: the axes of PLY files, as in camera space. */
const PLY_AXES = IS_RIGHT | IS_FRONT;

/** Coordinate systems are numbered from 1 to 16. */
export const LAST_COORDINATE_SYSTEM = 16;

/** Bit mask of the axes (1 for x, 2 for y, 4 for z) in which each harmonic of degrees 1 to 3 is odd. */
const ODD_AXES = [2, 4, 1, 3, 6, 0, 5, 0, 2, 7, 2, 4, 1, 4, 1];

/** Harmonics of degrees 1 to 3 after (x, y, z) -> (x, z, -y): terms of the original coefficients. */
const QUARTER_TURN: readonly (readonly (readonly [from: number, factor: number])[])[] = [
  [[1, -1]],
  [[0, 1]],
  [[2, 1]],
  [[6, -1]],
  [[4, -1]],
  [
    [5, -1 / 2],
    [7, -Math.sqrt(3) / 2],
  ],
  [[3, 1]],
  [
    [5, -Math.sqrt(3) / 2],
    [7, 1 / 2],
  ],
  [
    [11, Math.sqrt(5 / 8)],
    [13, -Math.sqrt(3 / 8)],
  ],
  [[9, -1]],
  [
    [11, Math.sqrt(3 / 8)],
    [13, Math.sqrt(5 / 8)],
  ],
  [
    [8, -Math.sqrt(5 / 8)],
    [10, -Math.sqrt(3 / 8)],
  ],
  [
    [12, -1 / 4],
    [14, -Math.sqrt(15) / 4],
  ],
  [
    [8, Math.sqrt(3 / 8)],
    [10, -Math.sqrt(5 / 8)],
  ],
  [
    [12, -Math.sqrt(15) / 4],
    [14, 1 / 4],
  ],
];

/** Rotates rows in place; slots as in `ROW_SLOT`. */
export type TurnRows = (rows: Float32Array, rowLength: number, rowCount: number) => void;

/**
 * Returns a function that converts splats from an SPZ coordinate system, by its number, to the axes
 * of PLY files; null if they are equal. Mirrored axes also affect rotations and harmonics.
 *
 * The conversion matches Niantic's library, the only writer of these numbers. Its names for 9 and
 * 10 (left or right, front, down), and for 15 and 16 (left or right, back, up), are interchanged.
 */
export function turnToPlyAxes(coordinateSystem: number): TurnRows | null {
  const axes = coordinateSystem - 1;
  if (axes === PLY_AXES) return null;
  const isZUp = (axes & IS_Z_UP) !== 0;
  const x = axes & IS_RIGHT ? 1 : -1;
  const first = axes & IS_UP ? -1 : 1;
  const second = axes & IS_FRONT ? 1 : -1;
  // Signs refer to the axes before the quarter turn, but are applied after it.
  const [y, z] = isZUp ? [second, first] : [first, second];
  const signs = ODD_AXES.map((odd) => (odd & 1 ? x : 1) * (odd & 2 ? y : 1) * (odd & 4 ? z : 1));
  return (rows, rowLength, rowCount) => {
    const harmonics = rowLength - ROW_SLOT.harmonics;
    const before = new Float32Array(harmonics);
    for (let i = 0; i < rowCount; i++) {
      const row = rows.subarray(i * rowLength, (i + 1) * rowLength);
      if (isZUp) quarterTurn(row, before);
      row[ROW_SLOT.position] *= x;
      row[ROW_SLOT.position + 1] *= y;
      row[ROW_SLOT.position + 2] *= z;
      row[ROW_SLOT.rotation + 1] *= y * z;
      row[ROW_SLOT.rotation + 2] *= x * z;
      row[ROW_SLOT.rotation + 3] *= x * y;
      for (let j = 0; j < harmonics; j++) row[ROW_SLOT.harmonics + j] *= signs[Math.floor(j / 3)];
    }
  };
}

/** (x, y, z) -> (x, z, -y): −90° about x. */
function quarterTurn(row: Float32Array, before: Float32Array): void {
  const y = row[ROW_SLOT.position + 1];
  row[ROW_SLOT.position + 1] = row[ROW_SLOT.position + 2];
  row[ROW_SLOT.position + 2] = -y;
  const [qw, qx, qy, qz] = row.subarray(ROW_SLOT.rotation, ROW_SLOT.rotation + 4);
  row[ROW_SLOT.rotation] = Math.SQRT1_2 * (qw + qx);
  row[ROW_SLOT.rotation + 1] = Math.SQRT1_2 * (qx - qw);
  row[ROW_SLOT.rotation + 2] = Math.SQRT1_2 * (qy + qz);
  row[ROW_SLOT.rotation + 3] = Math.SQRT1_2 * (qz - qy);
  before.set(row.subarray(ROW_SLOT.harmonics));
  for (let j = 0; j < before.length; j++) {
    let sum = 0;
    for (const [from, factor] of QUARTER_TURN[Math.floor(j / 3)]) sum += factor * before[3 * from + (j % 3)];
    row[ROW_SLOT.harmonics + j] = sum;
  }
}
