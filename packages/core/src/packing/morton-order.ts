import { coefficientsPerSplat, type SplatSet } from '../splats/splat-set.ts';
import { type Harmonics, isPacked } from './harmonics.ts';

/** Bits per axis of a Morton code: 48 in all, three passes of a 16-bit radix sort. */
const BITS_PER_AXIS = 16;
const RADIX = 1 << BITS_PER_AXIS;

/**
 * Storage order of splats: by the Morton code of their centres within the bounds; equal codes keep the given order.
 * Neighbours in space become neighbours in memory, so that a run of splats has small bounds.
 *
 * @param positions 3N finite coordinates.
 * @returns N indices into the given order.
 */
export function mortonOrder(positions: Float32Array, count: number): Uint32Array {
  const codes = mortonCodes(positions, count);
  let order: Uint32Array = Uint32Array.from({ length: count }, (_, i) => i);
  let next: Uint32Array = new Uint32Array(count);
  // Least significant digit first; each pass is stable, so equal codes keep the given order.
  for (const digits of codes) {
    const offsets = new Uint32Array(RADIX + 1);
    for (let i = 0; i < count; i++) offsets[digits[i] + 1]++;
    for (let digit = 0; digit < RADIX; digit++) offsets[digit + 1] += offsets[digit];
    for (let i = 0; i < count; i++) next[offsets[digits[order[i]]]++] = order[i];
    [order, next] = [next, order];
  }
  return order;
}

/** The splats of `set` that `order` lists, in that order. */
export function permuteSplats<Kind extends Harmonics>(
  set: SplatSet<Kind>,
  order: Uint32Array,
): SplatSet<Kind> {
  return {
    ...set,
    count: order.length,
    positions: permuted(set.positions, order, 3),
    logScales: permuted(set.logScales, order, 3),
    rotations: permuted(set.rotations, order, 4),
    opacityLogits: permuted(set.opacityLogits, order, 1),
    colorDc: permuted(set.colorDc, order, 3),
    harmonics: permutedHarmonics(set.harmonics, order),
    fileIndices: permuted(set.fileIndices, order, 1),
  };
}

/** The 48-bit codes as three columns of 16 bits, least significant first. */
function mortonCodes(positions: Float32Array, count: number): Uint16Array[] {
  const min = [Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY];
  const max = [Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (let i = 0; i < 3 * count; i++) {
    const axis = i % 3;
    if (positions[i] < min[axis]) min[axis] = positions[i];
    if (positions[i] > max[axis]) max[axis] = positions[i];
  }
  // One step for all axes: cells are cubes, so a flat scene does not waste its order on its thin side.
  const extent = Math.max(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
  const cellsPerUnit = extent > 0 ? (RADIX - 1) / extent : 0;
  const columns = [new Uint16Array(count), new Uint16Array(count), new Uint16Array(count)];
  for (let i = 0; i < count; i++) {
    const x = (positions[3 * i] - min[0]) * cellsPerUnit;
    const y = (positions[3 * i + 1] - min[1]) * cellsPerUnit;
    const z = (positions[3 * i + 2] - min[2]) * cellsPerUnit;
    // 16 bits of code take 5⅓ bits of each axis: interleave bit by bit through a table of spread bytes.
    const lowBits = spread(x & 0xff) | (spread(y & 0xff) << 1) | (spread(z & 0xff) << 2);
    const highBits = spread(x >> 8) | (spread(y >> 8) << 1) | (spread(z >> 8) << 2);
    columns[0][i] = lowBits & 0xffff;
    columns[1][i] = (lowBits >>> 16) | ((highBits & 0xff) << 8);
    columns[2][i] = highBits >>> 8;
  }
  return columns;
}

/** The eight bits of `byte` with two zeros between each. */
function spread(byte: number): number {
  let bits = (byte | (byte << 8)) & 0x00f00f;
  bits = (bits | (bits << 4)) & 0x0c30c3;
  return (bits | (bits << 2)) & 0x249249;
}

function permutedHarmonics<Kind extends Harmonics>(harmonics: Kind, order: Uint32Array): Kind {
  if (isPacked(harmonics)) {
    return { ...harmonics, words: permuted(harmonics.words, order, harmonics.wordsPerSplat) };
  }
  const width = coefficientsPerSplat(harmonics.degree);
  return { ...harmonics, coefficients: permuted(harmonics.coefficients, order, width) };
}

function permuted<Column extends Float32Array | Uint32Array>(
  column: Column,
  order: Uint32Array,
  width: number,
): Column {
  const result = new (column.constructor as new (length: number) => Column)(order.length * width);
  for (let i = 0; i < order.length; i++) {
    const from = order[i] * width;
    for (let k = 0; k < width; k++) result[i * width + k] = column[from + k];
  }
  return result;
}
