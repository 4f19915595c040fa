import { InvalidArgumentError } from '../../../data/errors.ts';
import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { largestComponent, normalizedRotation } from '../../../data/packing/rotation.ts';
import { opacityOf } from '../../../data/splats/color-values.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../../../data/splats/splat-set.ts';
import { packGzip, packGzipTo } from '../../containers/pack-gzip.ts';
import { SPZ_MAGIC } from '../first-bytes.ts';
import type { PieceFacts } from '../rows/piece-facts.ts';
import { medianSizeOf, type RoundingAdvice, RoundingMeter } from '../rows/rounding-meter.ts';
import {
  fileMemory,
  partOfProgress,
  readInTurns,
  type WriteFormat,
  type WritePieces,
  writeInTurns,
} from '../write-format.ts';
import { COLOR_SCALE, FLAG_ANTIALIASED, HEADER_BYTES } from './spz-layout.ts';

/** Later versions use Zstandard, for which there is no encoder here. */
const VERSION = 3;
/** As in all writers: positions are multiples of 1/4096, in 24 bits. */
const FRACTIONAL_BITS = 12;
const MOST_POSITION = 2 ** 23 - 1;
/** Log scales are multiples of 1/16, starting at −10. */
const SCALE_STEPS = 16;
const LEAST_LOG_SCALE = -10;
const ADVICE: RoundingAdvice = { title: 'SPZ', positions: 'Scale the scene up, or write PLY or glTF' };
/** Most bytes held when writing in pieces, besides the pieces themselves. */
const HELD_BYTES = 1 << 28;
/** Held bytes that are compressed at once. */
const PACKED_AT_ONCE = 1 << 18;
/**
 * Steps of harmonics, in 1/128: first of degree 1, then of higher degrees. The format's own library
 * keeps 5 and 4 of 8 bits, because gzip cannot compress the remaining noise.
 */
const FIRST_SH_STEP = 8;
const OTHER_SH_STEP = 16;
const FIRST_SH_VALUES = coefficientsPerSplat(1);
/** Progress when all splats are encoded, before compression. */
const ENCODED = 0.5;

/**
 * Writes SPZ, version 3, in the set's axes and order. Rounding steps:
 *
 * - positions: 1/4096
 * - log scales: 1/16 between −10 and 6
 * - opacities: 1/255
 * - base coefficients: 1/38 between −3.3 and 3.3
 * - rotation components: 1/723
 * - harmonics between −1 and 1: 1/16 at degree 1, 1/8 above
 *
 * Rejects with InvalidArgumentError 'set' if a coordinate is not between −2048 and 2048.
 */
export const write: WriteFormat = async (set, { signal, onProgress, onNote }) => {
  const { count, isAntialiased, harmonics } = set;
  const meter = new RoundingMeter(medianSizeOf(set));
  const attributes = attributesOf(harmonics.degree);
  const bytes = fileMemory(HEADER_BYTES + count * bytesOf(attributes));
  bytes.set(headerOf({ count, isAntialiased, shDegree: harmonics.degree }));
  const putRows = (from: number, to: number) => {
    for (let i = from; i < to; i++) measure(set, i, meter);
    let start = HEADER_BYTES;
    for (const { splatBytes, put } of attributes) {
      const part = bytes.subarray(start + from * splatBytes);
      for (let i = from; i < to; i++) put(set, i, part, (i - from) * splatBytes, 0);
      start += count * splatBytes;
    }
  };
  await writeInTurns(count, { signal, onProgress }, putRows, ENCODED);
  for (const note of meter.notes(ADVICE)) onNote?.(note);
  const onPacked = (fraction: number) => onProgress?.(ENCODED + (1 - ENCODED) * fraction);
  return packGzip(bytes, { signal, onProgress: onPacked });
};

/** As `write`, in several passes over the pieces. Each pass encodes as many attributes as memory allows. */
export const writePieces: WritePieces = async (pieces, options, put) => {
  const { count, medianSize } = pieces.facts;
  const meter = new RoundingMeter(medianSize);
  const passes = passesOf(attributesOf(pieces.facts.shDegree), HELD_BYTES / count);
  await packGzipTo(put, async (pack) => {
    await pack(headerOf(pieces.facts));
    for (const [pass, [first, ...others]] of passes.entries()) {
      const held = others.map(({ splatBytes }) => fileMemory(count * splatBytes));
      const part = partOfProgress(options, pass / passes.length, (pass + 1) / passes.length);
      await readInTurns(pieces, part, async (piece, before) => {
        const streamed = new Uint8Array(piece.count * first.splatBytes);
        for (let i = 0; i < piece.count; i++) {
          first.put(piece, i, streamed, i * first.splatBytes, before);
          if (pass === 0) measure(piece, i, meter);
        }
        for (const [k, { splatBytes, put: putOther }] of others.entries())
          for (let i = 0; i < piece.count; i++)
            putOther(piece, i, held[k], (before + i) * splatBytes, before);
        await pack(streamed);
      });
      for (const bytes of held)
        for (let at = 0; at < bytes.length; at += PACKED_AT_ONCE)
          await pack(bytes.subarray(at, at + PACKED_AT_ONCE));
    }
  });
  for (const note of meter.notes(ADVICE)) options.onNote?.(note);
};

/** Adds the rounding errors of splat `i`. */
function measure(set: SplatSet<Harmonics>, i: number, meter: RoundingMeter): void {
  meter.position(set, i, 2 ** -FRACTIONAL_BITS);
  meter.scales(set, i, (axis) => scaleByte(set.logScales[3 * i + axis]) / SCALE_STEPS + LEAST_LOG_SCALE);
  meter.color(set, i, (k) => (colorByte(set.colorDc[3 * i + k]) / 255 - 0.5) / COLOR_SCALE);
  meter.harmonics(set, i, (value, k) => (shByte(value, k) - 128) / 128);
}

/** An attribute of the file: one value per splat, contiguous over all splats. */
interface Attribute {
  readonly splatBytes: number;
  /**
   * Writes the value of splat `i` at `at`. `before` is the number of splats before the set, for
   * messages.
   */
  put(set: SplatSet<Harmonics>, i: number, bytes: Uint8Array, at: number, before: number): void;
}

function attributesOf(shDegree: ShDegree): Attribute[] {
  const shValues = coefficientsPerSplat(shDegree);
  const rotation = new Float64Array(4);
  const sh = new Float32Array(shValues);
  const attributes: Attribute[] = [
    { splatBytes: 9, put: putPosition },
    {
      splatBytes: 1,
      put(set, i, bytes, at) {
        bytes[at] = Math.round(255 * opacityOf(set.opacityLogits[i]));
      },
    },
    {
      splatBytes: 3,
      put(set, i, bytes, at) {
        for (let k = 0; k < 3; k++) bytes[at + k] = colorByte(set.colorDc[3 * i + k]);
      },
    },
    {
      splatBytes: 3,
      put(set, i, bytes, at) {
        for (let k = 0; k < 3; k++) bytes[at + k] = scaleByte(set.logScales[3 * i + k]);
      },
    },
    {
      splatBytes: 4,
      put(set, i, bytes, at) {
        normalizedRotation(set.rotations, 4 * i, rotation);
        putRotation(rotation, bytes, at);
      },
    },
    {
      splatBytes: shValues,
      put(set, i, bytes, at) {
        readCoefficients(set.harmonics, i, sh);
        for (let k = 0; k < shValues; k++) bytes[at + k] = shByte(sh[k], k);
      },
    },
  ];
  return attributes.filter(({ splatBytes }) => splatBytes > 0);
}

function bytesOf(attributes: readonly Attribute[]): number {
  return attributes.reduce((sum, { splatBytes }) => sum + splatBytes, 0);
}

/**
 * Divides the attributes into passes that hold at most this many bytes per splat, besides the first
 * attribute of a pass.
 */
function passesOf(attributes: readonly Attribute[], mostHeldBytes: number): Attribute[][] {
  const passes: Attribute[][] = [];
  for (const attribute of attributes) {
    const last = passes.at(-1);
    if (last && bytesOf([...last.slice(1), attribute]) <= mostHeldBytes) last.push(attribute);
    else passes.push([attribute]);
  }
  return passes;
}

function headerOf({
  count,
  shDegree,
  isAntialiased,
}: Pick<PieceFacts, 'count' | 'shDegree' | 'isAntialiased'>): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(HEADER_BYTES);
  const view = new DataView(bytes.buffer);
  for (let i = 0; i < SPZ_MAGIC.length; i++) view.setUint8(i, SPZ_MAGIC.charCodeAt(i));
  view.setUint32(4, VERSION, true);
  view.setUint32(8, count, true);
  view.setUint8(12, shDegree);
  view.setUint8(13, FRACTIONAL_BITS);
  view.setUint8(14, isAntialiased ? FLAG_ANTIALIASED : 0);
  return bytes;
}

const putPosition: Attribute['put'] = ({ positions, origin }, i, bytes, at, before) => {
  for (let axis = 0; axis < 3; axis++) {
    const k = 3 * i + axis;
    const value = positions[k] + origin[axis];
    const steps = Math.round(value * 2 ** FRACTIONAL_BITS);
    if (Math.abs(steps) > MOST_POSITION) {
      const found = `Splat ${before + i} has ${'xyz'[axis]} = ${value}; coordinates in SPZ are from -2048 to 2048`;
      const advice = 'Move or scale the scene, crop it, or write another format';
      throw new InvalidArgumentError('set', `${found}. ${advice}.`);
    }
    bytes[at + 3 * axis] = steps;
    bytes[at + 3 * axis + 1] = steps >> 8;
    bytes[at + 3 * axis + 2] = steps >> 16;
  }
};

/** Writes x, y, z, w without the largest, made positive: each a sign and 9 bits, up to √½. */
function putRotation(rotation: Float64Array, bytes: Uint8Array, at: number): void {
  const largest = largestComponent(rotation);
  const isReversed = rotation[largest] < 0;
  // The file orders components as x, y, z, w.
  let word = (largest + 3) & 3;
  for (let i = 1; i <= 4; i++) {
    const value = rotation[i & 3];
    if ((i & 3) === largest) continue;
    const magnitude = Math.round(511 * Math.SQRT2 * Math.abs(value));
    word = (word << 10) | (value < 0 !== isReversed ? 512 : 0) | magnitude;
  }
  for (let i = 0; i < 4; i++) bytes[at + i] = word >>> (8 * i);
}

function scaleByte(logScale: number): number {
  return toByte(SCALE_STEPS * (logScale - LEAST_LOG_SCALE));
}

function colorByte(coefficient: number): number {
  return toByte(255 * (COLOR_SCALE * coefficient + 0.5));
}

function shByte(value: number, index: number): number {
  const step = index < FIRST_SH_VALUES ? FIRST_SH_STEP : OTHER_SH_STEP;
  return toByte(128 + step * Math.round((128 * value) / step));
}

function toByte(value: number): number {
  return Math.max(0, Math.min(255, Math.round(value)));
}
