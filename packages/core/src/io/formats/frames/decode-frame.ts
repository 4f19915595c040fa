import { SplatFileError } from '../../../data/errors.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { productOf } from '../../../data/packing/rotation.ts';
import { logitOf } from '../../../data/splats/color-values.ts';
import {
  coefficientsPerSplat,
  type ShDegree,
  type SomeColumns,
  type SplatColumns,
  type TrainedHarmonics,
} from '../../../data/splats/splat-set.ts';
import { crc32 } from '../../containers/crc32.ts';
import { unpackZlib } from '../../containers/gzip.ts';
import { type FrameColumn, unpackColumns } from './frame-columns.ts';
import {
  CHUNK_NUMBERS,
  COLOR_STEPS,
  COLUMN,
  columnCountOf,
  type FrameEntry,
  KEY_HEAD_BYTES,
  keyHeadBytes,
  LOG_SCALE_STEPS,
  OPACITY_STEPS,
  ROTATION_STEPS,
} from './frames-layout.ts';

/** A decoded key frame. */
export interface KeyFrame {
  readonly splatCount: number;
  readonly shDegree: ShDegree;
  readonly origin: Vec3;
  /** CHUNK_NUMBERS for each chunk. */
  readonly chunks: Float32Array<ArrayBuffer>;
  readonly columns: readonly FrameColumn[];
  /** 4N: unit quaternions w, x, y, z. */
  readonly rotations: Float64Array;
}

/** A frame of a file, packed. Can be posted. */
export interface PackedFrame {
  /** Name of the file. */
  readonly file: string;
  readonly number: number;
  readonly entry: FrameEntry;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

const AGAIN = 'Download or convert it again';
const LARGEST = 3.4e38;
/** Logits of all opacities. */
const LOGITS = Float32Array.from({ length: OPACITY_STEPS + 1 }, (_, steps) => logitOf(steps / OPACITY_STEPS));

/** Rejects with SplatFileError 'truncated', 'damaged'. */
export async function decodeKey(frame: PackedFrame): Promise<KeyFrame> {
  const { splatCount, shDegree } = frame.entry;
  const bytes = await unpacked(frame);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const headBytes = keyHeadBytes(splatCount);
  const origin = [0, 8, 16].map((at) => view.getFloat64(at, true));
  const chunks = Float32Array.from({ length: (headBytes - KEY_HEAD_BYTES) / 4 }, (_, i) =>
    view.getFloat32(KEY_HEAD_BYTES + 4 * i, true),
  );
  if (![...origin, ...chunks].every(Number.isFinite)) throw damaged(frame, 'has places that are not finite');
  const columns = columnsOf(frame, bytes.subarray(headBytes));
  return {
    ...{ splatCount, shDegree, origin: origin as unknown as Vec3, chunks, columns },
    rotations: rotationsOf(columns, splatCount),
  };
}

/** Decodes the difference to a key frame. Rejects with SplatFileError 'truncated', 'damaged'. */
export async function decodeDifference(frame: PackedFrame): Promise<readonly FrameColumn[]> {
  return columnsOf(frame, await unpacked(frame));
}

async function unpacked(frame: PackedFrame): Promise<Uint8Array<ArrayBuffer>> {
  const { file, number, entry, bytes } = frame;
  if (bytes.length < entry.bytes) {
    const message = `frame ${number} takes ${entry.bytes} bytes, of which the file has ${bytes.length}. ${AGAIN}.`;
    throw new SplatFileError('truncated', file, message, { byte: entry.offset + bytes.length });
  }
  if (crc32(bytes) !== entry.crc) throw damaged(frame, 'is not as it was written (CRC-32 differs)');
  const what = `${file}, frame ${number}`;
  const result = await unpackZlib(bytes, entry.unpackedBytes, what, entry.offset);
  if (result.length !== entry.unpackedBytes)
    throw damaged(frame, `unpacks to ${result.length} bytes, not ${entry.unpackedBytes}`);
  return result;
}

function columnsOf(frame: PackedFrame, bytes: Uint8Array): readonly FrameColumn[] {
  const { shDegree, splatCount } = frame.entry;
  const columns = unpackColumns(bytes, columnCountOf(shDegree), splatCount);
  if (!columns) throw damaged(frame, 'has columns that cannot be read');
  return columns;
}

function damaged({ file, number, entry }: PackedFrame, message: string): SplatFileError {
  return new SplatFileError('damaged', file, `frame ${number} ${message}. ${AGAIN}.`, { byte: entry.offset });
}

/** Unit quaternions of a key frame. */
export function rotationsOf(columns: readonly FrameColumn[], splatCount: number): Float64Array {
  const rotations = new Float64Array(4 * splatCount);
  for (let i = 0; i < splatCount; i++) turnOf(columns, i, rotations, 4 * i);
  return rotations;
}

/** Writes the unit quaternion of a splat's rotation vector. */
function turnOf(columns: readonly FrameColumn[], i: number, target: Float64Array, at: number): void {
  const x = (columns[COLUMN.rotation]?.[i] ?? 0) / ROTATION_STEPS;
  const y = (columns[COLUMN.rotation + 1]?.[i] ?? 0) / ROTATION_STEPS;
  const z = (columns[COLUMN.rotation + 2]?.[i] ?? 0) / ROTATION_STEPS;
  const angle = Math.sqrt(x * x + y * y + z * z);
  const sine = angle > 0 ? Math.sin(angle / 2) / angle : 0;
  target[at] = Math.cos(angle / 2);
  target[at + 1] = sine * x;
  target[at + 2] = sine * y;
  target[at + 3] = sine * z;
}

/** Differences to a key frame; null: of the key frame itself. */
type Difference = readonly FrameColumn[] | null;

/** The splats of a frame without harmonics, in storage order. */
export function columnsOfSplats(key: KeyFrame, difference: Difference): SplatColumns {
  const columns = columnsWhere(() => true, key, difference);
  const fileIndices = new Uint32Array(key.splatCount);
  for (let i = 0; i < key.splatCount; i++) fileIndices[i] = i;
  return { ...(columns as Required<SomeColumns>), origin: key.origin, fileIndices, dropped: {} };
}

/** The columns for `changedCloud`: those of a frame, except harmonics, that differ from its key frame's. */
export function changedColumns(key: KeyFrame, difference: Difference): SomeColumns {
  const isChanged = (first: number, end: number) => !!difference?.slice(first, end).some((column) => column);
  return columnsWhere(isChanged, key, difference);
}

/** @param isWanted asked for the columns of each property, from the first up to but not including the last. */
function columnsWhere(
  isWanted: (first: number, end: number) => boolean,
  key: KeyFrame,
  difference: Difference,
): SomeColumns {
  const { position, logScale, rotation, opacity, colorDc, harmonics } = COLUMN;
  return {
    count: key.splatCount,
    // Where log scales are wanted, positions are, too.
    positions: isWanted(position, rotation) ? positionsOf(key, difference) : undefined,
    logScales: isWanted(logScale, rotation)
      ? triplesOf(key, difference, logScale, LOG_SCALE_STEPS)
      : undefined,
    rotations: isWanted(rotation, opacity) ? turned(key, difference) : undefined,
    opacityLogits: isWanted(opacity, colorDc) ? opacityLogitsOf(key, difference) : undefined,
    colorDc: isWanted(colorDc, harmonics) ? triplesOf(key, difference, colorDc, COLOR_STEPS) : undefined,
  };
}

/** The harmonics of a frame's splats. */
export function harmonicsOfSplats(key: KeyFrame, difference: Difference): TrainedHarmonics {
  const { splatCount, shDegree: degree } = key;
  const width = coefficientsPerSplat(degree);
  const coefficients = new Float32Array(width * splatCount);
  for (let k = 0; k < width; k++) {
    putColumn(coefficients, k, width, pairOf(key, difference, COLUMN.harmonics + k), COLOR_STEPS);
  }
  return { degree, coefficients };
}

/** Values of three columns from `first` on. */
function triplesOf(key: KeyFrame, difference: Difference, first: number, steps: number): Float32Array {
  const values = new Float32Array(3 * key.splatCount);
  for (let axis = 0; axis < 3; axis++)
    putColumn(values, axis, 3, pairOf(key, difference, first + axis), steps);
  return values;
}

function opacityLogitsOf(key: KeyFrame, difference: Difference): Float32Array {
  const logits = new Float32Array(key.splatCount);
  putColumn(logits, 0, 1, pairOf(key, difference, COLUMN.opacity), 1);
  for (let i = 0; i < logits.length; i++) logits[i] = LOGITS[Math.max(0, Math.min(OPACITY_STEPS, logits[i]))];
  return logits;
}

/** A column of a key frame, and its difference. */
type ColumnPair = readonly [own: FrameColumn, difference: FrameColumn];

function pairOf(key: KeyFrame, difference: Difference, column: number): ColumnPair {
  return [key.columns[column], difference?.[column] ?? null];
}

function putColumn(
  target: Float32Array,
  slot: number,
  stride: number,
  [own, difference]: ColumnPair,
  steps: number,
): void {
  const count = target.length / stride;
  for (let i = 0, at = slot; i < count; i++, at += stride)
    target[at] = ((own ? own[i] : 0) + (difference ? difference[i] : 0)) / steps;
}

function positionsOf(key: KeyFrame, frame: Difference): Float32Array {
  const { chunks, splatCount } = key;
  const positions = new Float32Array(3 * splatCount);
  for (let axis = 0; axis < 3; axis++) {
    const [own, difference] = pairOf(key, frame, COLUMN.position + axis);
    for (let i = 0; i < splatCount; i++) {
      const chunk = CHUNK_NUMBERS * Math.floor(i / CHUNK_SPLATS);
      const steps = (own ? own[i] : 0) + (difference ? difference[i] : 0);
      const value = chunks[chunk + axis] + chunks[chunk + 3] * steps;
      // Files may hold any number; float32 holds only these.
      positions[3 * i + axis] = Math.max(-LARGEST, Math.min(LARGEST, value));
    }
  }
  return positions;
}

/** Rotations of a frame: those of the key frame, then turned in their own axes. */
function turned({ rotations }: KeyFrame, difference: Difference): Float32Array {
  const result = new Float32Array(rotations);
  if (!difference) return result;
  const turn = new Float64Array(4);
  for (let at = 0; at < result.length; at += 4) {
    turnOf(difference, at / 4, turn, 0);
    const own = [rotations[at], rotations[at + 1], rotations[at + 2], rotations[at + 3]];
    result.set(productOf(own, turn), at);
  }
  return result;
}
