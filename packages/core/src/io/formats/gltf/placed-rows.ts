import { identity4, linearPart, type Mat4, type Vec3 } from '../../../data/math/mat4.ts';
import { polarDecomposition } from '../../../data/math/polar-decomposition.ts';
import { writeRotationMatrix } from '../../../data/math/rotation-matrix.ts';
import { normalizedRotation } from '../../../data/packing/rotation.ts';
import { HarmonicsTurn } from '../../../data/splats/harmonics-turn.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { type DecodedRows, rowLength } from '../rows/decoded-rows.ts';

/** Relative tolerance for equal axis lengths: writers round matrices to float32. */
const ROUNDING = 1e-6;
/** A smaller rotation changes coefficients by less than float32 rounding. */
const LEAST_TURN = 1e-9;
/** Pairs of matrix columns, as offsets. */
const COLUMN_PAIRS = [
  [0, 3],
  [0, 6],
  [3, 6],
] as const;
/** Jacobi's method converges quadratically: 3×3 matrices need five or six sweeps. */
const MOST_SWEEPS = 16;

/** Why `matrix` cannot transform splats; undefined if it can. */
export function reasonNotToPlace(matrix: Mat4): string | undefined {
  if (!columnsOf(matrix).lengths.every((length) => length > 0 && Number.isFinite(length)))
    return 'an axis has no length, or no finite one';
  return polarDecomposition(linearPart(matrix)) ? undefined : 'its axes lie in a plane';
}

/** Whether a matrix leaves splats unchanged. */
export function isIdentity(matrix: Mat4): boolean {
  return identity4().every((value, i) => matrix[i] === value);
}

/**
 * Transforms splats by a node's matrix, for which `reasonNotToPlace` is undefined.
 *
 * Splats stay ellipsoids under any scale, shear or mirroring. Their covariance becomes M·C·Cᵀ·Mᵀ,
 * where M is the matrix and C has the splat's axes as columns. Harmonics are rotated by the
 * rotation of M's polar decomposition, as in `cloudView`.
 *
 * @param origin origin of the result, subtracted in float64 before rounding to float32.
 */
export function placedRows(rows: DecodedRows, matrix: Mat4, origin: Vec3): DecodedRows {
  const { rotation: turn } = polarDecomposition(linearPart(matrix))!;
  const { lengths, axes } = columnsOf(matrix);
  const moveShape = isSimilarity(lengths, axes) ? turnedShape(lengths, axes) : stretchedShape(matrix);
  const isTurned = turn.some((value, i) => Math.abs(value - (i % 4 === 0 ? 1 : 0)) > LEAST_TURN);
  const harmonics = isTurned && rows.shDegree > 0 ? new HarmonicsTurn(rows.shDegree, turn) : null;
  const rowValues = rowLength(rows.shDegree);
  const fromOrigin = matrix.slice();
  for (const [axis, value] of origin.entries()) fromOrigin[12 + axis] -= value;
  return {
    ...rows,
    origin,
    byteHarmonics: undefined,
    decode(values, rowCount) {
      rows.decode(values, rowCount);
      for (let row = 0; row < rowCount; row++) {
        const at = row * rowValues;
        movePosition(values, at + ROW_SLOT.position, fromOrigin);
        moveShape(values, at);
        harmonics?.apply(values, at + ROW_SLOT.harmonics);
      }
    },
  };
}

/** Transforms a point from node space to scene space. */
export function placedPoint([x, y, z]: Vec3, m: Mat4): Vec3 {
  return [
    m[0] * x + m[4] * y + m[8] * z + m[12],
    m[1] * x + m[5] * y + m[9] * z + m[13],
    m[2] * x + m[6] * y + m[10] * z + m[14],
  ];
}

function isSimilarity([x, y, z]: readonly number[], axes: Float64Array): boolean {
  const isEven = Math.max(x, y, z) <= (1 + ROUNDING) * Math.min(x, y, z);
  return isEven && COLUMN_PAIRS.every(([a, b]) => Math.abs(dot(axes, a, b)) <= ROUNDING);
}

/** Transforms rotation and scales of the row at `at`, in place. */
type MoveShape = (values: Float32Array, at: number) => void;

/** Lengths of a matrix's columns, and the 3×3 matrix of normalised columns. */
function columnsOf(m: Mat4): { lengths: number[]; axes: Float64Array } {
  const lengths = [0, 4, 8].map((column) => Math.hypot(m[column], m[column + 1], m[column + 2]));
  const axes = Float64Array.from({ length: 9 }, (_, i) => m[4 * Math.floor(i / 3) + (i % 3)]);
  for (let i = 0; i < 9; i++) axes[i] /= lengths[Math.floor(i / 3)];
  return { lengths, axes };
}

function movePosition(values: Float32Array, at: number, m: Mat4): void {
  const x = values[at];
  const y = values[at + 1];
  const z = values[at + 2];
  // As `placedPoint`, without an array per splat.
  values[at] = m[0] * x + m[4] * y + m[8] * z + m[12];
  values[at + 1] = m[1] * x + m[5] * y + m[9] * z + m[13];
  values[at + 2] = m[2] * x + m[6] * y + m[10] * z + m[14];
}

function turnedShape(lengths: readonly number[], axes: Float64Array): MoveShape {
  const logScale = lengths.reduce((sum, length) => sum + Math.log(length), 0) / 3;
  // Reversing all axes leaves an ellipsoid unchanged, and turns a mirroring into a rotation.
  const [w, x, y, z] = quaternionOf(axes, new Float64Array(4));
  return (values, at) => {
    for (let i = 0; i < 3; i++) values[at + ROW_SLOT.logScale + i] += logScale;
    const q = at + ROW_SLOT.rotation;
    const qx = values[q + 1];
    const qy = values[q + 2];
    const qz = values[q + 3];
    const isZero = values[q] === 0 && qx === 0 && qy === 0 && qz === 0;
    const qw = isZero ? 1 : values[q];
    values[q] = w * qw - x * qx - y * qy - z * qz;
    values[q + 1] = w * qx + x * qw + y * qz - z * qy;
    values[q + 2] = w * qy - x * qz + y * qw + z * qx;
    values[q + 3] = w * qz + x * qy - y * qx + z * qw;
  };
}

/**
 * Finds the axes M·C·Cᵀ·Mᵀ = U·S²·Uᵀ by rotating the columns of M·C until they are perpendicular
 * (one-sided Jacobi method). Unlike an eigendecomposition of the covariance, it keeps the precision
 * of thin axes next to long ones.
 */
function stretchedShape(m: Mat4): MoveShape {
  const unit = new Float64Array(4);
  const splatAxes = new Float64Array(9);
  const columns = new Float64Array(9);
  return (values, at) => {
    normalizedRotation(values, at + ROW_SLOT.rotation, unit);
    writeRotationMatrix(unit, splatAxes);
    for (let column = 0; column < 3; column++) {
      const scale = Math.exp(values[at + ROW_SLOT.logScale + column]);
      const x = splatAxes[3 * column];
      const y = splatAxes[3 * column + 1];
      const z = splatAxes[3 * column + 2];
      for (let row = 0; row < 3; row++)
        columns[3 * column + row] = (m[row] * x + m[4 + row] * y + m[8 + row] * z) * scale;
    }
    makePerpendicular(columns);
    for (let column = 0; column < 3; column++) {
      const length = Math.hypot(columns[3 * column], columns[3 * column + 1], columns[3 * column + 2]);
      values[at + ROW_SLOT.logScale + column] = Math.log(length);
      for (let row = 0; row < 3; row++) columns[3 * column + row] /= length;
    }
    quaternionOf(columns, unit);
    for (let i = 0; i < 4; i++) values[at + ROW_SLOT.rotation + i] = unit[i];
  };
}

/** Rotates pairs of columns within their plane until all are perpendicular. */
function makePerpendicular(columns: Float64Array): void {
  for (let sweep = 0; sweep < MOST_SWEEPS; sweep++) {
    let isDone = true;
    for (const [a, b] of COLUMN_PAIRS) {
      const aa = dot(columns, a, a);
      const bb = dot(columns, b, b);
      const ab = dot(columns, a, b);
      if (Math.abs(ab) <= 1e-15 * Math.sqrt(aa) * Math.sqrt(bb)) continue;
      isDone = false;
      const slope = (bb - aa) / (2 * ab);
      const tangent = (slope < 0 ? -1 : 1) / (Math.abs(slope) + Math.sqrt(1 + slope * slope));
      const cosine = 1 / Math.sqrt(1 + tangent * tangent);
      const sine = tangent * cosine;
      for (let row = 0; row < 3; row++) {
        const left = columns[a + row];
        const right = columns[b + row];
        columns[a + row] = cosine * left - sine * right;
        columns[b + row] = sine * left + cosine * right;
      }
    }
    if (isDone) return;
  }
}

function dot(columns: Float64Array, a: number, b: number): number {
  return columns[a] * columns[b] + columns[a + 1] * columns[b + 1] + columns[a + 2] * columns[b + 2];
}

/** Writes the unit quaternion w, x, y, z of an orthogonal matrix; of its negative, if it mirrors. */
function quaternionOf(m: Float64Array, result: Float64Array): Float64Array {
  const determinant =
    m[0] * (m[4] * m[8] - m[5] * m[7]) -
    m[3] * (m[1] * m[8] - m[2] * m[7]) +
    m[6] * (m[1] * m[5] - m[2] * m[4]);
  const sign = determinant < 0 ? -1 : 1;
  // 4w², 4x², 4y², 4z². The largest is at least 1, so no divisor is small.
  const ww = 1 + sign * (m[0] + m[4] + m[8]);
  const xx = 1 + sign * (m[0] - m[4] - m[8]);
  const yy = 1 + sign * (m[4] - m[0] - m[8]);
  const zz = 1 + sign * (m[8] - m[0] - m[4]);
  const wx = sign * (m[5] - m[7]);
  const wy = sign * (m[6] - m[2]);
  const wz = sign * (m[1] - m[3]);
  const yz = sign * (m[5] + m[7]);
  const zx = sign * (m[6] + m[2]);
  const xy = sign * (m[1] + m[3]);
  if (ww >= xx && ww >= yy && ww >= zz) setUnit(result, ww, wx, wy, wz);
  else if (xx >= yy && xx >= zz) setUnit(result, wx, xx, xy, zx);
  else if (yy >= zz) setUnit(result, wy, xy, yy, yz);
  else setUnit(result, wz, zx, yz, zz);
  return result;
}

function setUnit(result: Float64Array, w: number, x: number, y: number, z: number): void {
  const inverse = 1 / Math.sqrt(w * w + x * x + y * y + z * z);
  result[0] = w * inverse;
  result[1] = x * inverse;
  result[2] = y * inverse;
  result[3] = z * inverse;
}
