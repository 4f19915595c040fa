import type { RecordPrecision } from '../data/accuracy/accuracy.ts';
import { fromHalfBits } from '../data/layout/half.ts';
import { SPLAT_RECORDS } from '../data/layout/structs.ts';
import type { InspectedFrame } from './inspected-frame.ts';

/** The record of a visible splat, as `project` wrote it. */
export interface DecodedRecord {
  /** Number of the splat, counted through all chunks of the frame; see `InspectedFrame.locate`. */
  readonly splat: number;
  readonly centerPx: readonly number[];
  /** Major half axis at √2 standard deviations: x, y. */
  readonly majorPx: readonly number[];
  /**
   * Minor half axis, perpendicular to the major one except for rounding at `recordPrecision:
   * 'paper'`.
   */
  readonly minorPx: readonly number[];
  readonly minorLengthPx: number;
  readonly depthView: number;
  /** r, g, b and opacity. */
  readonly color: readonly number[];
}

const recordsOf = new WeakMap<InspectedFrame, Promise<readonly DecodedRecord[]>>();

/** Reads the records of all visible splats, in the order of `visibleSplats`; once per frame. */
export function readRecords(frame: InspectedFrame): Promise<readonly DecodedRecord[]> {
  const records = recordsOf.get(frame) ?? parseRecords(frame);
  recordsOf.set(frame, records);
  return records;
}

async function parseRecords(frame: InspectedFrame): Promise<readonly DecodedRecord[]> {
  const count = await frame.visibleCount();
  const visibleSplats = await frame.words('visibleSplats');
  const words = await frame.words('records');
  const { recordPrecision } = frame.accuracy;
  const length = SPLAT_RECORDS[recordPrecision].bytes / 4;
  return Array.from({ length: count }, (_, i) => ({
    splat: visibleSplats[i],
    ...decodeRecord(words.subarray(i * length, (i + 1) * length), recordPrecision),
  }));
}

/** Decodes the words of one record. */
export function decodeRecord(words: Uint32Array, precision: RecordPrecision): Omit<DecodedRecord, 'splat'> {
  return precision === 'paper' ? readPaperRecord(words) : readRecord(words, precision);
}

function readRecord(words: Uint32Array, precision: 'f32' | 'f16'): Omit<DecodedRecord, 'splat'> {
  const { offsets } = SPLAT_RECORDS[precision];
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  const vector = (field: keyof typeof offsets, length: number) =>
    Array.from(floats.subarray(offsets[field] / 4, offsets[field] / 4 + length));
  const [x, y] = vector('majorPx', 2);
  const [minorLengthPx] = vector('minorLengthPx', 1);
  const perpendicular = minorLengthPx / Math.hypot(x, y);
  const color = offsets.color / 4;
  return {
    centerPx: vector('centerPx', 2),
    majorPx: [x, y],
    minorPx: [-y * perpendicular, x * perpendicular],
    minorLengthPx,
    depthView: vector('depthView', 1)[0],
    color:
      precision === 'f32' ? vector('color', 4) : words.subarray(color, color + 2).reduce(appendHalves, []),
  };
}

function readPaperRecord(words: Uint32Array): Omit<DecodedRecord, 'splat'> {
  const { offsets } = SPLAT_RECORDS.paper;
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  const minorPx = appendHalves([], words[offsets.minorPx / 4]);
  const center = offsets.centerPx / 4;
  return {
    centerPx: Array.from(floats.subarray(center, center + 2)),
    majorPx: appendHalves([], words[offsets.majorPx / 4]),
    minorPx,
    minorLengthPx: Math.hypot(...minorPx),
    depthView: floats[offsets.depthView / 4],
    color: [0, 8, 16, 24].map((shift) => ((words[offsets.color / 4] >>> shift) & 0xff) / 255),
  };
}

function appendHalves(values: number[], word: number): number[] {
  return [...values, fromHalfBits(word & 0xffff), fromHalfBits(word >>> 16)];
}
