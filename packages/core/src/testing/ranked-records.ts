import type { RecordPrecision } from '../data/accuracy/accuracy.ts';
import { toHalfBits } from '../data/layout/half.ts';
import { SPLAT_RECORDS } from '../data/layout/structs.ts';
import { type DecodedRecord, decodeRecord } from '../inspect/read-records.ts';
import { seededRandom } from './seeded-random.ts';
import type { TestGpu } from './test-gpu.ts';

/** A splat as it is drawn; lengths in pixels, y down. */
export interface DrawnSplat {
  readonly centerPx: readonly [number, number];
  /** Half axes at √2 standard deviations. */
  readonly majorLengthPx: number;
  readonly minorLengthPx: number;
  /** Angle of the major axis, from the image's x to its y. */
  readonly angle: number;
  readonly opacity: number;
  /** Default white. */
  readonly rgb?: readonly [number, number, number];
  /** Default 1. */
  readonly depthView?: number;
}

/** A record with exactly the numbers that the GPU reads. */
export type RankedRecord = Omit<DecodedRecord, 'splat'>;

export interface RankedRecords {
  /** Nearest first. */
  readonly records: readonly RankedRecord[];
  /** Place of each in the buffer of records, in the same order: another one. */
  readonly places: Uint32Array;
  /** Words of that buffer. */
  readonly words: Uint32Array;
}

/** Packs the records of `ranked` splats, nearest first, in no order. */
export function rankedRecords(ranked: readonly DrawnSplat[], precision: RecordPrecision): RankedRecords {
  const { bytes } = SPLAT_RECORDS[precision];
  const buffer = new ArrayBuffer(bytes * ranked.length);
  const places = shuffled(ranked.length);
  for (const [rank, splat] of ranked.entries()) writeRecord(buffer, bytes * places[rank], splat, precision);
  const words = new Uint32Array(buffer);
  const length = bytes / 4;
  const records = Array.from(places, (place) =>
    decodeRecord(words.subarray(length * place, length * (place + 1)), precision),
  );
  return { records, places, words };
}

/** Buffers of the visible splats in the form that stages read: the order has the farthest first. */
export function rankedBuffers(gpu: TestGpu, { places, words }: RankedRecords) {
  return {
    visibleCount: gpu.storage([places.length]),
    order: gpu.storage(places.toReversed()),
    records: gpu.storage(words),
  };
}

/** The numbers 0…count − 1 in no order, the same on every call. */
export function shuffled(count: number): Uint32Array {
  const random = seededRandom(count);
  const numbers = Uint32Array.from({ length: count }, (_, i) => i);
  for (let i = count - 1; i > 0; i--) {
    const other = Math.floor((i + 1) * random());
    [numbers[i], numbers[other]] = [numbers[other], numbers[i]];
  }
  return numbers;
}

function writeRecord(
  target: ArrayBuffer,
  offset: number,
  { centerPx, majorLengthPx, minorLengthPx, angle, opacity, rgb = [1, 1, 1], depthView = 1 }: DrawnSplat,
  precision: RecordPrecision,
): void {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  const common = { centerPx, depthView };
  const majorPx = [majorLengthPx * cos, majorLengthPx * sin];
  const color = [...rgb, opacity];
  if (precision === 'paper') {
    const minorPx = [-minorLengthPx * sin, minorLengthPx * cos];
    const bytes = color.map((value) => Math.round(255 * Math.min(1, value)));
    const fields = { majorPx: halves(majorPx), minorPx: halves(minorPx), color: bytesWord(bytes) };
    SPLAT_RECORDS.paper.write(target, { ...common, ...fields }, offset);
  } else if (precision === 'f16') {
    const fields = { majorPx, minorLengthPx, color: [halves(color.slice(0, 2)), halves(color.slice(2))] };
    SPLAT_RECORDS.f16.write(target, { ...common, ...fields }, offset);
  } else {
    SPLAT_RECORDS.f32.write(target, { ...common, majorPx, minorLengthPx, color }, offset);
  }
}

function halves([low, high]: readonly number[]): number {
  return (toHalfBits(low) | (toHalfBits(high) << 16)) >>> 0;
}

function bytesWord(bytes: readonly number[]): number {
  return bytes.reduce((word, byte, i) => (word | (byte << (8 * i))) >>> 0, 0);
}
