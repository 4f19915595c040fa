import { SplatFileError } from '../../../data/errors.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { logitOf } from '../../../data/splats/color-values.ts';
import {
  coefficientsPerSplat,
  type ShDegree,
  type SplatColumns,
  type TrainedHarmonics,
} from '../../../data/splats/splat-set.ts';
import { crc32 } from '../../containers/crc32.ts';
import { unpackZlib } from '../../containers/gzip.ts';
import { type Column, unpackColumns } from './frame-columns.ts';
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
  readonly columns: readonly Column[];
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
export async function decodeDifference(frame: PackedFrame): Promise<readonly Column[]> {
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

function columnsOf(frame: PackedFrame, bytes: Uint8Array): readonly Column[] {
  const { shDegree, splatCount } = frame.entry;
  const columns = unpackColumns(bytes, columnCountOf(shDegree), splatCount);
  if (!columns) throw damaged(frame, 'has columns that cannot be read');
  return columns;
}

function damaged({ file, number, entry }: PackedFrame, message: string): SplatFileError {
  return new SplatFileError('damaged', file, `frame ${number} ${message}. ${AGAIN}.`, { byte: entry.offset });
}

/** Unit quaternions of a key frame. */
export function rotationsOf(columns: readonly Column[], splatCount: number): Float64Array {
  const rotations = new Float64Array(4 * splatCount);
  for (let i = 0; i < splatCount; i++) turnOf(columns, i, rotations, 4 * i);
  return rotations;
}

/** Writes the unit quaternion of a splat's rotation vector. */
function turnOf(columns: readonly Column[], i: number, target: Float64Array, at: number): void {
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

/** The splats of a frame without harmonics, in storage order. @param difference null: of the key frame itself. */
export function columnsOfSplats(key: KeyFrame, difference: readonly Column[] | null): SplatColumns {
  const { splatCount: count, origin, chunks } = key;
  const [positions, logScales, colorDc] = [0, 1, 2].map(() => new Float32Array(3 * count));
  const opacityLogits = new Float32Array(count);
  const pair = (column: number) => [key.columns[column], difference?.[column] ?? null] as const;
  for (let axis = 0; axis < 3; axis++) {
    putPositions(positions, axis, chunks, pair(COLUMN.position + axis));
    putColumn(logScales, axis, 3, pair(COLUMN.logScale + axis), LOG_SCALE_STEPS);
    putColumn(colorDc, axis, 3, pair(COLUMN.colorDc + axis), COLOR_STEPS);
  }
  putColumn(opacityLogits, 0, 1, pair(COLUMN.opacity), 1);
  for (let i = 0; i < count; i++)
    opacityLogits[i] = LOGITS[Math.max(0, Math.min(OPACITY_STEPS, opacityLogits[i]))];
  const fileIndices = new Uint32Array(count);
  for (let i = 0; i < count; i++) fileIndices[i] = i;
  return {
    ...{ count, origin, positions, logScales, colorDc, opacityLogits },
    rotations: turned(key, difference),
    fileIndices,
    dropped: {},
  };
}

/** The harmonics of a frame's splats. */
export function harmonicsOfSplats(key: KeyFrame, difference: readonly Column[] | null): TrainedHarmonics {
  const { splatCount, shDegree: degree, columns } = key;
  const width = coefficientsPerSplat(degree);
  const coefficients = new Float32Array(width * splatCount);
  for (let k = 0; k < width; k++) {
    const column = COLUMN.harmonics + k;
    putColumn(coefficients, k, width, [columns[column], difference?.[column] ?? null], COLOR_STEPS);
  }
  return { degree, coefficients };
}

function putColumn(
  target: Float32Array,
  slot: number,
  stride: number,
  [own, difference]: readonly [Column, Column],
  steps: number,
): void {
  const count = target.length / stride;
  for (let i = 0, at = slot; i < count; i++, at += stride)
    target[at] = ((own ? own[i] : 0) + (difference ? difference[i] : 0)) / steps;
}

function putPositions(
  target: Float32Array,
  axis: number,
  chunks: Float32Array,
  [own, difference]: readonly [Column, Column],
): void {
  for (let i = 0; 3 * i < target.length; i++) {
    const chunk = CHUNK_NUMBERS * Math.floor(i / CHUNK_SPLATS);
    const steps = (own ? own[i] : 0) + (difference ? difference[i] : 0);
    const value = chunks[chunk + axis] + chunks[chunk + 3] * steps;
    // Files may hold any number; float32 holds only these.
    target[3 * i + axis] = Math.max(-LARGEST, Math.min(LARGEST, value));
  }
}

/** Rotations of a frame: those of the key frame, then turned in their own axes. */
function turned({ rotations, splatCount }: KeyFrame, difference: readonly Column[] | null): Float32Array {
  const result = new Float32Array(rotations);
  const isTurned = difference?.slice(COLUMN.rotation, COLUMN.opacity).some((column) => column !== null);
  if (!isTurned) return result;
  const turn = new Float64Array(4);
  for (let i = 0; i < splatCount; i++) {
    turnOf(difference!, i, turn, 0);
    const at = 4 * i;
    const [a, b, c, d] = [rotations[at], rotations[at + 1], rotations[at + 2], rotations[at + 3]];
    const [w, x, y, z] = [turn[0], turn[1], turn[2], turn[3]];
    result[at] = a * w - b * x - c * y - d * z;
    result[at + 1] = a * x + b * w + c * z - d * y;
    result[at + 2] = a * y - b * z + c * w + d * x;
    result[at + 3] = a * z + b * y - c * x + d * w;
  }
  return result;
}
