// A second float64 renderer, for tests of the positions and colours of splats. It shares no code with
// src/reference: splats are means, covariances and colours by direction, all in world space.
import type { Camera } from '../data/camera/camera.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';

/** A 3×3 matrix as three columns of x, y, z. */
export type Columns = readonly (readonly number[])[];

/** A splat in the world. */
interface WorldSplat {
  readonly mean: readonly number[];
  readonly covariance: Columns;
  readonly opacity: number;
  /** Colour seen along a unit vector of the world, from the camera to the splat. */
  readonly colorAlong: (direction: readonly number[]) => readonly number[];
}

const SIZE_PX = 64;
const DILATION_PX2 = 0.3;
const CUTOFF = 1 / 255;

const dot = (a: readonly number[], b: readonly number[]) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: readonly number[], b: readonly number[]) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
/** Row `row` of a matrix of columns. */
const rowOf = (m: Columns, row: number) => m.map((column) => column[row]);
const apply = (m: Columns, v: readonly number[]) => [0, 1, 2].map((row) => dot(rowOf(m, row), v));
const multiply = (a: Columns, b: Columns): Columns => b.map((column) => apply(a, column));
const transpose = (m: Columns): Columns => [0, 1, 2].map((row) => rowOf(m, row));

/**
 * The orthogonal matrix nearest to one: the mean of a matrix and of the transpose of its inverse,
 * again and again.
 */
function nearestRotation(m: Columns): Columns {
  let found = m;
  for (let step = 0; step < 100; step++) {
    const [a, b, c] = found;
    const volume = dot(a, cross(b, c));
    const inverseTransposed = [cross(b, c), cross(c, a), cross(a, b)].map((v) => v.map((x) => x / volume));
    found = found.map((column, i) => column.map((value, k) => (value + inverseTransposed[i][k]) / 2));
  }
  return found;
}

/**
 * The splats of a set, placed by a matrix in float64: covariances by all of it, harmonics by its
 * rotation, as KHR_gaussian_splatting has it.
 *
 * @param matrix 16 values, column-major, from the set's scene to the world.
 */
export function worldSplats(set: SplatSet, matrix: ArrayLike<number>): WorldSplat[] {
  const linear = [0, 4, 8].map((at) => [matrix[at], matrix[at + 1], matrix[at + 2]]);
  const back = transpose(nearestRotation(linear));
  return Array.from({ length: set.count }, (_, i) => {
    const at = [0, 1, 2].map((axis) => set.positions[3 * i + axis] + set.origin[axis]);
    const rotation = Array.from(set.rotations.subarray(4 * i, 4 * i + 4));
    const [w, x, y, z] = rotation.map((value) => value / Math.hypot(...rotation));
    const turned = [
      [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
      [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
      [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ];
    const axes = turned.map((axis, k) => axis.map((value) => value * Math.exp(set.logScales[3 * i + k])));
    const placed = multiply(linear, axes);
    return {
      mean: apply(linear, at).map((value, axis) => value + matrix[12 + axis]),
      covariance: multiply(placed, transpose(placed)),
      opacity: 1 / (1 + Math.exp(-set.opacityLogits[i])),
      colorAlong: (direction) => colorOf(set, i, apply(back, direction)),
    };
  });
}

/** Colour of a splat along a unit vector in the space of its harmonics. */
function colorOf(
  { colorDc, harmonics: { degree, coefficients } }: SplatSet,
  i: number,
  d: readonly number[],
): number[] {
  const [x, y, z] = d;
  const [xx, yy, zz] = [x * x, y * y, z * z];
  const basis = [
    ...[-0.4886025119029199 * y, 0.4886025119029199 * z, -0.4886025119029199 * x],
    ...[1.0925484305920792 * x * y, -1.0925484305920792 * y * z, 0.31539156525252005 * (2 * zz - xx - yy)],
    ...[-1.0925484305920792 * x * z, 0.5462742152960396 * (xx - yy), -0.5900435899266435 * y * (3 * xx - yy)],
    ...[2.890611442640554 * x * y * z, -0.4570457994644658 * y * (4 * zz - xx - yy)],
    ...[0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy), -0.4570457994644658 * x * (4 * zz - xx - yy)],
    ...[1.445305721320277 * z * (xx - yy), -0.5900435899266435 * x * (xx - 3 * yy)],
  ];
  const count = [0, 3, 8, 15][degree];
  return [0, 1, 2].map((channel) => {
    let sum = 0.5 + 0.28209479177387814 * colorDc[3 * i + channel];
    for (let k = 0; k < count; k++) sum += basis[k] * coefficients[3 * (count * i + k) + channel];
    return Math.max(0, sum);
  });
}

/** The image of splats, 64×64 pixels: r, g, b and opacity of each, premultiplied, top row first. */
export function float64Picture(splats: readonly WorldSplat[], camera: Camera): Float64Array {
  const v = camera.viewMatrix;
  const p = camera.projectionMatrix;
  const toView = [0, 4, 8].map((at) => [v[at], v[at + 1], v[at + 2]]);
  const [focalX, focalY] = [(p[0] * SIZE_PX) / 2, (p[5] * SIZE_PX) / 2];
  // The position of the camera: differences to it are exact where the view's translation is not.
  const eye = apply(transpose(toView), [-v[12], -v[13], -v[14]]);
  const isOrthographic = p[11] === 0;
  const forward = apply(transpose(toView), [0, 0, -1]);
  const limit = 1.3;
  const clamp = (tangent: number, scale: number) =>
    Math.max(-limit / scale, Math.min(limit / scale, tangent));
  const drawn = splats.flatMap((splat) => {
    const toward = splat.mean.map((value, axis) => value - eye[axis]);
    const [x, y, minusDepth] = apply(toView, toward);
    const depth = -minusDepth;
    if (!(depth > camera.near && depth <= camera.far)) return [];
    const divisor = isOrthographic ? 1 : depth;
    const tangents = isOrthographic ? [0, 0] : [clamp(x / depth, p[0]), clamp(y / depth, p[5])];
    const rowX = [focalX / divisor, 0, (focalX / divisor) * tangents[0]];
    const rowY = [0, -focalY / divisor, (-focalY / divisor) * tangents[1]];
    const [u, w] = [rowX, rowY].map((row) => apply(transpose(toView), row));
    const [su, sw] = [u, w].map((row) => apply(splat.covariance, row));
    const length = Math.hypot(...toward);
    return {
      ...{
        depth,
        opacity: splat.opacity,
        a: dot(u, su) + DILATION_PX2,
        b: dot(u, sw),
        c: dot(w, sw) + DILATION_PX2,
      },
      centerX: SIZE_PX / 2 + (focalX * x) / divisor,
      centerY: SIZE_PX / 2 - (focalY * y) / divisor,
      color: splat.colorAlong(isOrthographic ? forward : toward.map((value) => value / length)),
    };
  });
  drawn.sort((one, other) => other.depth - one.depth);
  const data = new Float64Array(4 * SIZE_PX * SIZE_PX);
  for (const { a, b, c, centerX, centerY, opacity, color } of drawn) {
    if (opacity < CUTOFF) continue;
    const mostDistance2 = 2 * Math.log(opacity / CUTOFF);
    const [left, right] = pixelsAround(centerX, Math.sqrt(a * mostDistance2));
    const [top, bottom] = pixelsAround(centerY, Math.sqrt(c * mostDistance2));
    for (let row = top; row < bottom; row++)
      for (let column = left; column < right; column++) {
        const x = column + 0.5 - centerX;
        const y = row + 0.5 - centerY;
        const distance2 = (c * x * x - 2 * b * x * y + a * y * y) / (a * c - b * b);
        const alpha = Math.min(0.99, opacity * Math.exp(-distance2 / 2));
        if (alpha < CUTOFF) continue;
        const at = 4 * (row * SIZE_PX + column);
        for (const [channel, value] of [...color, 1].entries())
          data[at + channel] = value * alpha + data[at + channel] * (1 - alpha);
      }
  }
  return data;
}

/** The columns, or rows, that a splat reaches, and one more on each side: first, and one after the last. */
function pixelsAround(center: number, reachPx: number): readonly [first: number, end: number] {
  return [Math.max(0, Math.floor(center - reachPx) - 1), Math.min(SIZE_PX, Math.ceil(center + reachPx) + 1)];
}

/** Peak signal-to-noise ratio of the colours of two images over black, decibels. */
export function psnrOf(image: ArrayLike<number>, expected: ArrayLike<number>): number {
  const value = (from: ArrayLike<number>, i: number) => Math.max(0, Math.min(1, from[i]));
  let sum = 0;
  for (let i = 0; i < expected.length; i++) if (i % 4 < 3) sum += (value(image, i) - value(expected, i)) ** 2;
  return -10 * Math.log10(sum / (expected.length * 0.75));
}
