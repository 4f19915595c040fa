import { checkArray, checkColumn } from '../../features/edits/splat-edits.data.ts';
import { InvalidArgumentError } from '../errors.ts';
import { wrongArgument } from '../given.ts';
import { isFiniteF32 } from '../math/float-step.ts';
import { principalAxes } from '../math/principal-axes.ts';
import { quaternionOfAxes } from '../math/quaternion-of-axes.ts';
import { shown } from '../printable.ts';
import { colorDcOf, logitOf } from '../splats/color-values.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../splats/splat-set.ts';
import { placeSplats } from './place-splats.ts';

/**
 * Splats as arrays, N rows in any order. Give sizes as `scales` or as `covariances`, colours as
 * `colors` or as `sh`. Arrays are copied.
 */
export interface SplatArrays {
  /** 3N: centres x, y, z. Float64Array keeps the precision of large coordinates. */
  readonly positions: ArrayLike<number>;
  /** 3N: standard deviations along the local axes, above 0, in units of `positions`. */
  readonly scales?: ArrayLike<number>;
  /** 4N: quaternions x, y, z, w, of any length above 0, which turn local axes. Default: no turn. */
  readonly rotations?: ArrayLike<number>;
  /** 6N, instead of `scales` and `rotations`: covariances xx, xy, xz, yy, yz, zz. */
  readonly covariances?: ArrayLike<number>;
  /** N: opacities at the splats' centres, 0…1. Default 1. */
  readonly opacities?: ArrayLike<number>;
  /**
   * 3N: base colours r, g, b, sRGB-encoded, where 0 is black and 1 is white. They look the same
   * from everywhere.
   */
  readonly colors?: ArrayLike<number>;
  /**
   * 3N, 12N, 27N or 48N, instead of `colors`: coefficients of spherical harmonics of degree 0, 1, 2
   * or 3 as they are trained, in ascending (degree, order), each as r, g, b. The first give the
   * base colour, as 0.5 + 0.2820948 · coefficient, sRGB-encoded.
   */
  readonly sh?: ArrayLike<number>;
  /** Whether the splats were trained with an antialias filter. Default unknown: drawn without. */
  readonly isAntialiased?: boolean;
}

/** Coefficients of each splat, by degree. */
const SH_WIDTHS = [3, 12, 27, 48] as const;
/** Least standard deviation, as a share of the largest: flat splats have none along an axis. */
const FLATTEST = 1e-6;

/**
 * Makes a set of splats of arrays. Row i is the i-th splat of each.
 *
 * @throws InvalidArgumentError naming the array that is missing, beside one that it excludes, or of
 *   a wrong length; or the array, the index and the value found.
 * @example
 * const set = splatsFromArrays({
 *   positions: [0, 0, 0, 1, 0, 0],
 *   scales: [0.1, 0.1, 0.1, 0.2, 0.1, 0.1],
 *   colors: [1, 0, 0, 0, 0, 1],
 * });
 * const cloud = engine.add(set);
 */
export function splatsFromArrays(arrays: SplatArrays): SplatSet {
  if (typeof arrays !== 'object' || arrays === null)
    throw new InvalidArgumentError('arrays', `The arrays are ${shown(arrays)}; they must be an object.`);
  const { positions, scales, rotations, covariances, opacities, colors, sh, isAntialiased } = arrays;
  checkArray('positions', positions);
  const count = positions.length / 3;
  if (!Number.isInteger(count)) {
    const message = `positions has ${shown(positions.length)} values; it must have 3 for each splat.`;
    throw new InvalidArgumentError('positions', message);
  }
  checkColumn('positions', 'positions', positions, count);
  checkOneOf('scales', scales, 'covariances', covariances);
  checkOneOf('colors', colors, 'sh', sh);
  const shapes = covariances
    ? shapesOfCovariances(covariances, rotations, count)
    : shapesOfScales(scales!, rotations, count);
  if (opacities !== undefined) {
    checkArray('opacities', opacities);
    checkColumn('opacities', 'opacities', opacities, count);
  }
  if (isAntialiased !== undefined && typeof isAntialiased !== 'boolean') {
    throw wrongArgument('isAntialiased', isAntialiased, 'true or false');
  }
  return {
    count,
    ...placeSplats(Float64Array.from(positions)),
    ...shapes,
    opacityLogits: Float32Array.from({ length: count }, (_, i) => logitOf(opacities ? opacities[i] : 1)),
    ...(sh ? colorsOfSh(sh, count) : colorsOf(colors!, count)),
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
    dropped: {},
    ...(isAntialiased !== undefined && { isAntialiased }),
  };
}

type Shapes = Pick<SplatSet, 'logScales' | 'rotations'>;
type Colors = Pick<SplatSet, 'colorDc' | 'harmonics'>;

function shapesOfScales(
  scales: ArrayLike<number>,
  rotations: ArrayLike<number> | undefined,
  count: number,
): Shapes {
  checkColumn('scales', 'scales', scales, count);
  if (rotations !== undefined) {
    checkArray('rotations', rotations);
    checkColumn('rotations', 'rotations', rotations, count);
  }
  const turned = new Float32Array(4 * count);
  for (let i = 0; i < count; i++) {
    turned[4 * i] = rotations ? rotations[4 * i + 3] : 1;
    for (let axis = 0; rotations && axis < 3; axis++) turned[4 * i + 1 + axis] = rotations[4 * i + axis];
  }
  return { logScales: Float32Array.from(scales, Math.log), rotations: turned };
}

function shapesOfCovariances(
  covariances: ArrayLike<number>,
  rotations: ArrayLike<number> | undefined,
  count: number,
): Shapes {
  if (rotations !== undefined) throw excluded('rotations', 'covariances');
  checkWidth('covariances', covariances, count, [6]);
  checkFinite('covariances', covariances, 6);
  const logScales = new Float32Array(3 * count);
  const turned = new Float32Array(4 * count);
  for (let i = 0; i < count; i++) {
    const [xx, xy, xz, yy, yz, zz] = [0, 1, 2, 3, 4, 5].map((k) => covariances[6 * i + k]);
    const axes = principalAxes(Float64Array.of(xx, xy, xz, xy, yy, yz, xz, yz, zz), 3);
    const variances = [0, 1, 2].map((axis) => {
      const [x, y, z] = axes.subarray(3 * axis, 3 * axis + 3);
      return x * (x * xx + 2 * y * xy + 2 * z * xz) + y * (y * yy + 2 * z * yz) + z * z * zz;
    });
    if (!(variances[0] > 0)) {
      const message = `covariances[${6 * i}…${6 * i + 5}], of splat ${i}, has no positive variance (${shown(variances[0])} at most); a splat has a size.`;
      throw new InvalidArgumentError('covariances', message);
    }
    const least = variances[0] * FLATTEST ** 2;
    for (let axis = 0; axis < 3; axis++)
      logScales[3 * i + axis] = Math.log(Math.max(variances[axis], least)) / 2;
    turned.set(quaternionOfAxes(axes), 4 * i);
  }
  return { logScales, rotations: turned };
}

function colorsOf(colors: ArrayLike<number>, count: number): Colors {
  checkColumn('colors', 'colors', colors, count);
  return {
    colorDc: Float32Array.from(colors, colorDcOf),
    harmonics: { degree: 0, coefficients: new Float32Array() },
  };
}

function colorsOfSh(sh: ArrayLike<number>, count: number): Colors {
  const width = checkWidth('sh', sh, count, SH_WIDTHS);
  checkFinite('sh', sh, width);
  const degree = SH_WIDTHS.indexOf(width as (typeof SH_WIDTHS)[number]) as ShDegree;
  const rest = coefficientsPerSplat(degree);
  const colorDc = new Float32Array(3 * count);
  const coefficients = new Float32Array(rest * count);
  for (let i = 0; i < count; i++) {
    for (let k = 0; k < 3; k++) colorDc[3 * i + k] = sh[width * i + k];
    for (let k = 0; k < rest; k++) coefficients[rest * i + k] = sh[width * i + 3 + k];
  }
  return { colorDc, harmonics: { degree, coefficients } };
}

/** Returns how many values there are for each splat; the first of `widths` without splats. */
function checkWidth(
  name: string,
  values: ArrayLike<number>,
  count: number,
  widths: readonly number[],
): number {
  const width = widths.find((each) => values.length === each * count);
  if (width !== undefined) return width;
  const message = `${name} has ${shown(values.length)} values; ${count} splats need ${widths.map((each) => each * count).join(', ')}.`;
  throw new InvalidArgumentError(name, message);
}

function checkFinite(name: string, values: ArrayLike<number>, width: number): void {
  for (let i = 0; i < values.length; i++) {
    if (isFiniteF32(values[i])) continue;
    const message = `${name}[${i}], of splat ${Math.floor(i / width)}, is ${shown(values[i])}; they are finite numbers that float32 holds.`;
    throw new InvalidArgumentError(name, message);
  }
}

function checkOneOf(a: string, valuesA: unknown, b: string, valuesB: unknown): void {
  if (valuesA !== undefined && valuesB !== undefined) throw excluded(a, b);
  if (valuesB === undefined) checkArray(a, valuesA, ` Give ${a}, or ${b} instead.`);
  else checkArray(b, valuesB);
}

function excluded(a: string, b: string): InvalidArgumentError {
  return new InvalidArgumentError(a, `There are ${a} beside ${b}; give one of them.`);
}
