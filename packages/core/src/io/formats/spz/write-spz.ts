import { InvalidArgumentError } from '../../../data/errors.ts';
import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { largestComponent, normalizedRotation } from '../../../data/packing/rotation.ts';
import { opacityOf } from '../../../data/splats/color-values.ts';
import { coefficientsPerSplat, type SplatSet } from '../../../data/splats/splat-set.ts';
import { packGzip } from '../../containers/pack-gzip.ts';
import { fileMemory, type WriteFormat, writeInTurns } from '../write-format.ts';
import { SPZ_MAGIC } from './spz-format.ts';
import { COLOR_SCALE, FLAG_ANTIALIASED, HEADER_BYTES } from './spz-layout.ts';

/** Later versions pack by Zstandard, for which there is no encoder here. */
const VERSION = 3;
/** As every writer has it: positions are multiples of 1/4096, in 24 bits. */
const FRACTIONAL_BITS = 12;
const MOST_POSITION = 2 ** 23 - 1;
/** Bytes of a splat without harmonics. */
const SPLAT_BYTES = 20;
/**
 * Steps of harmonics of degree 1, and of the others, in 1/128: the format's own library keeps 5 and 4 bits of the 8, since gzip makes
 * nothing of the rest.
 */
const FIRST_SH_STEP = 8;
const OTHER_SH_STEP = 16;
const FIRST_SH_VALUES = coefficientsPerSplat(1);
/** What `onProgress` is told when all splats are encoded and none are packed. */
const ENCODED = 0.5;

/**
 * Writes SPZ, version 3, in the axes and the order of the set. What is lost: positions are rounded to 1/4096, log scales to 1/16 between
 * −10 and 6, opacities to 1/255, base coefficients to 1/38 between −3.3 and 3.3, components of rotations to 1/723, harmonics to 1/16 (of
 * degree 1) and 1/8 between −1 and 1.
 *
 * Rejects with InvalidArgumentError 'set' if a coordinate is not between −2048 and 2048.
 */
export const write: WriteFormat = async (set, { signal, onProgress }) => {
  const { count, harmonics } = set;
  const shValues = coefficientsPerSplat(harmonics.degree);
  const bytes = fileMemory(HEADER_BYTES + count * (SPLAT_BYTES + shValues));
  putHeader(set, new DataView(bytes.buffer));
  // One attribute of all splats after another.
  let start = HEADER_BYTES;
  const attribute = (splatBytes: number) => {
    const part = bytes.subarray(start, start + count * splatBytes);
    start += part.length;
    return part;
  };
  const [positions, alphas, colors, scales, rotations] = [9, 1, 3, 3, 4].map(attribute);
  const shBytes = attribute(shValues);
  const rotation = new Float64Array(4);
  const sh = new Float32Array(shValues);
  const putRows = (from: number, to: number) => {
    for (let i = from; i < to; i++) {
      putPosition(set, i, positions);
      alphas[i] = Math.round(255 * opacityOf(set.opacityLogits[i]));
      for (let k = 3 * i; k < 3 * i + 3; k++) {
        colors[k] = toByte(255 * (COLOR_SCALE * set.colorDc[k] + 0.5));
        scales[k] = toByte(16 * (set.logScales[k] + 10));
      }
      normalizedRotation(set.rotations, 4 * i, rotation);
      putRotation(rotation, rotations, 4 * i);
      readCoefficients(harmonics, i, sh);
      for (let k = 0; k < shValues; k++) shBytes[i * shValues + k] = shByte(sh[k], k);
    }
  };
  await writeInTurns(count, { signal, onProgress }, putRows, ENCODED);
  const onPacked = (fraction: number) => onProgress?.(ENCODED + (1 - ENCODED) * fraction);
  return packGzip(bytes, { signal, onProgress: onPacked });
};

function putHeader({ count, harmonics, isAntialiased }: SplatSet<Harmonics>, view: DataView): void {
  for (let i = 0; i < SPZ_MAGIC.length; i++) view.setUint8(i, SPZ_MAGIC.charCodeAt(i));
  view.setUint32(4, VERSION, true);
  view.setUint32(8, count, true);
  view.setUint8(12, harmonics.degree);
  view.setUint8(13, FRACTIONAL_BITS);
  view.setUint8(14, isAntialiased ? FLAG_ANTIALIASED : 0);
}

function putPosition({ positions, origin }: SplatSet<Harmonics>, i: number, bytes: Uint8Array): void {
  for (let axis = 0; axis < 3; axis++) {
    const k = 3 * i + axis;
    const value = positions[k] + origin[axis];
    const steps = Math.round(value * 2 ** FRACTIONAL_BITS);
    if (Math.abs(steps) > MOST_POSITION) {
      const found = `Splat ${i} has ${'xyz'[axis]} = ${value}; coordinates in SPZ are from -2048 to 2048`;
      const advice = 'Move or scale the scene, crop it, or write another format';
      throw new InvalidArgumentError('set', `${found}. ${advice}.`);
    }
    bytes[3 * k] = steps;
    bytes[3 * k + 1] = steps >> 8;
    bytes[3 * k + 2] = steps >> 16;
  }
}

/** All of x, y, z, w but the largest, where that one is positive: each a sign and 9 bits, up to √½. */
function putRotation(rotation: Float64Array, bytes: Uint8Array, at: number): void {
  const largest = largestComponent(rotation);
  const isReversed = rotation[largest] < 0;
  // In the file, w is the last.
  let word = (largest + 3) & 3;
  for (let i = 1; i <= 4; i++) {
    const value = rotation[i & 3];
    if ((i & 3) === largest) continue;
    const magnitude = Math.round(511 * Math.SQRT2 * Math.abs(value));
    word = (word << 10) | (value < 0 !== isReversed ? 512 : 0) | magnitude;
  }
  for (let i = 0; i < 4; i++) bytes[at + i] = word >>> (8 * i);
}

function shByte(value: number, index: number): number {
  const step = index < FIRST_SH_VALUES ? FIRST_SH_STEP : OTHER_SH_STEP;
  return toByte(128 + step * Math.round((128 * value) / step));
}

function toByte(value: number): number {
  return Math.max(0, Math.min(255, Math.round(value)));
}
