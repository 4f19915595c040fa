import { SplatFileError } from '../../../data/errors.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import { crc32 } from '../../containers/crc32.ts';
import { FRAMES_MAGIC, latin1 } from '../first-bytes.ts';
import { rowLength } from '../rows/decoded-rows.ts';

// A file begins with a header and an entry for each frame; packed frames follow in order. A frame is
// a key frame, or the difference to the key frame before it.

const VERSION = 1;
/** Bytes before the entries. */
export const HEADER_BYTES = 32;
/** Byte offsets in the header, which begins with the magic number. */
export const HEADER = {
  version: 8,
  frameCount: 12,
  /** f64. */
  framesPerS: 16,
  flags: 24,
} as const;
/** Flags of a file. This one: the file states whether the splats were trained with an antialias filter. */
const TELLS_ANTIALIASED = 1;
const IS_ANTIALIASED = 2;
/** Byte offsets in the entry of a frame. CRC-32 of the header and all entries follows the last entry. */
const ENTRY = {
  /** u64 */
  offset: 0,
  /** Bytes of the frame in the file. */
  bytes: 8,
  unpackedBytes: 12,
  /** CRC-32 of the bytes in the file. */
  crc: 16,
  /** Number of its key frame; its own if it is one. */
  key: 20,
  splatCount: 24,
  shDegree: 28,
  /** Including three reserved bytes. */
  entryBytes: 32,
} as const;

/** Lowest rate of playback, per second: durations stay finite. */
const LEAST_FRAMES_PER_S = 0.001;
/** Highest rate of playback, per second. */
const MOST_FRAMES_PER_S = 1000;
/** Rates of playback per second, for messages. */
export const FRAME_RATES = `${LEAST_FRAMES_PER_S} to ${MOST_FRAMES_PER_S}`;

export function isFrameRate(framesPerS: number): boolean {
  return framesPerS >= LEAST_FRAMES_PER_S && framesPerS <= MOST_FRAMES_PER_S;
}

/** A day at 48 frames per second: an index of 128 MiB. */
export const MOST_FRAMES = 1 << 22;

// Columns of integers of an unpacked frame, in this order; harmonics follow.

/** First column of each property. */
export const COLUMN = {
  /** Steps of the chunk from its least corner on. */
  position: 0,
  logScale: 3,
  /** Rotation vector, in the frame of the key's rotation; of a key frame, in the scene's. */
  rotation: 6,
  opacity: 9,
  colorDc: 10,
  harmonics: 13,
} as const;
export const LOG_SCALE_STEPS = 64;
/** Steps per radian. */
export const ROTATION_STEPS = 512;
export const OPACITY_STEPS = 1023;
/** Steps of coefficients of any degree, per unit. */
export const COLOR_STEPS = 128;
/** Numbers, float32, of a chunk of CHUNK_SPLATS in a key frame: its least corner, and the step of positions. */
export const CHUNK_NUMBERS = 4;
/** Bytes of a key frame before its chunks: its origin, 3 × f64. */
export const KEY_HEAD_BYTES = 24;

export function columnCountOf(shDegree: ShDegree): number {
  return COLUMN.harmonics + coefficientsPerSplat(shDegree);
}

/** Bytes of a key frame before its columns. */
export function keyHeadBytes(splatCount: number): number {
  return KEY_HEAD_BYTES + 4 * CHUNK_NUMBERS * Math.ceil(splatCount / CHUNK_SPLATS);
}

/** Where a frame lies in its file. Can be posted. */
export interface FrameEntry {
  readonly offset: number;
  readonly bytes: number;
  readonly unpackedBytes: number;
  readonly crc: number;
  readonly key: number;
  readonly splatCount: number;
  readonly shDegree: ShDegree;
}

export interface FramesHeader {
  readonly framesPerS: number;
  readonly isAntialiased: boolean | undefined;
  readonly entries: readonly FrameEntry[];
}

/** Bytes of header and entries. */
export function headerBytesOf(frameCount: number): number {
  return HEADER_BYTES + ENTRY.entryBytes * frameCount + 4;
}

export function writeHeader({ framesPerS, isAntialiased, entries }: FramesHeader): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(headerBytesOf(entries.length));
  const view = new DataView(bytes.buffer);
  for (let i = 0; i < FRAMES_MAGIC.length; i++) bytes[i] = FRAMES_MAGIC.charCodeAt(i);
  view.setUint32(HEADER.version, VERSION, true);
  view.setUint32(HEADER.frameCount, entries.length, true);
  view.setFloat64(HEADER.framesPerS, framesPerS, true);
  const flags = (isAntialiased === undefined ? 0 : TELLS_ANTIALIASED) | (isAntialiased ? IS_ANTIALIASED : 0);
  view.setUint8(HEADER.flags, flags);
  for (const [i, entry] of entries.entries()) {
    const at = HEADER_BYTES + ENTRY.entryBytes * i;
    view.setBigUint64(at + ENTRY.offset, BigInt(entry.offset), true);
    view.setUint32(at + ENTRY.bytes, entry.bytes, true);
    view.setUint32(at + ENTRY.unpackedBytes, entry.unpackedBytes, true);
    view.setUint32(at + ENTRY.crc, entry.crc, true);
    view.setUint32(at + ENTRY.key, entry.key, true);
    view.setUint32(at + ENTRY.splatCount, entry.splatCount, true);
    view.setUint8(at + ENTRY.shDegree, entry.shDegree);
  }
  const end = bytes.length - 4;
  view.setUint32(end, crc32(bytes.subarray(0, end)), true);
  return bytes;
}

const EXPORT_AGAIN = 'Download or convert it again';

/**
 * Reads how many frames a file has.
 *
 * @param bytes first bytes of the file; all bytes of a file that is too short.
 * @throws SplatFileError 'unknown-format', 'bad-header', 'truncated', 'too-large', 'empty'
 */
export function readFrameCount(bytes: Uint8Array, file: string): number {
  const magic = latin1(bytes.subarray(0, FRAMES_MAGIC.length));
  if (magic !== FRAMES_MAGIC.slice(0, magic.length)) {
    const message = 'it does not begin as a file of frames does. Make one with npx @websplatter/cli convert.';
    throw new SplatFileError('unknown-format', file, message, { byte: 0 });
  }
  checkLength(bytes, HEADER_BYTES, file);
  const view = new DataView(bytes.buffer, bytes.byteOffset, HEADER_BYTES);
  const version = view.getUint32(HEADER.version, true);
  if (version !== VERSION) {
    const message = `it is of version ${version}; version ${VERSION} is read. Use a newer version of this library.`;
    throw new SplatFileError('bad-header', file, message, { byte: HEADER.version });
  }
  const frameCount = view.getUint32(HEADER.frameCount, true);
  const place = { byte: HEADER.frameCount };
  if (frameCount === 0) throw new SplatFileError('empty', file, 'the header promises 0 frames.', place);
  if (frameCount > MOST_FRAMES) {
    const message = `the header promises ${frameCount} frames; ${MOST_FRAMES} are the most. Divide the scene.`;
    throw new SplatFileError('too-large', file, message, place);
  }
  return frameCount;
}

function checkLength(bytes: Uint8Array, needed: number, file: string): void {
  if (bytes.length >= needed) return;
  const message = `the header takes ${needed} bytes, the file has ${bytes.length}. ${EXPORT_AGAIN}.`;
  throw new SplatFileError('truncated', file, message, { byte: bytes.length });
}

/**
 * Reads header and entries, and checks that frames follow each other, each after its key frame.
 *
 * @param bytes the first `headerBytesOf(readFrameCount(…))` bytes, or all of a shorter file.
 * @throws SplatFileError 'truncated', 'damaged', and as `readFrameCount`
 */
export function readHeader(bytes: Uint8Array, file: string): FramesHeader {
  const frameCount = readFrameCount(bytes, file);
  const headerBytes = headerBytesOf(frameCount);
  checkLength(bytes, headerBytes, file);
  const view = new DataView(bytes.buffer, bytes.byteOffset, headerBytes);
  const fail = (message: string, byte: number): never => {
    throw new SplatFileError('damaged', file, `${message}. ${EXPORT_AGAIN}.`, { byte });
  };
  const end = headerBytes - 4;
  if (view.getUint32(end, true) !== crc32(bytes.subarray(0, end)))
    fail('its header is not as it was written (CRC-32 differs)', 0);
  const framesPerS = view.getFloat64(HEADER.framesPerS, true);
  if (!isFrameRate(framesPerS))
    fail(`it has ${framesPerS} frames per second; files have ${FRAME_RATES}`, HEADER.framesPerS);
  const entries: FrameEntry[] = [];
  let next = headerBytes;
  for (let i = 0; i < frameCount; i++) {
    const at = HEADER_BYTES + ENTRY.entryBytes * i;
    const shDegree = view.getUint8(at + ENTRY.shDegree);
    if (shDegree > 3) fail(`frame ${i} has harmonics of degree ${shDegree}; there are 0 to 3`, at);
    const entry: FrameEntry = {
      offset: Number(view.getBigUint64(at + ENTRY.offset, true)),
      bytes: view.getUint32(at + ENTRY.bytes, true),
      unpackedBytes: view.getUint32(at + ENTRY.unpackedBytes, true),
      crc: view.getUint32(at + ENTRY.crc, true),
      key: view.getUint32(at + ENTRY.key, true),
      splatCount: view.getUint32(at + ENTRY.splatCount, true),
      shDegree: shDegree as ShDegree,
    };
    const { offset, key, splatCount, unpackedBytes } = entry;
    if (offset !== next) fail(`frame ${i} begins at byte ${offset}, not ${next}`, at);
    if (splatCount === 0) fail(`frame ${i} has no splats`, at);
    const isLikeKey = splatCount === entries[key]?.splatCount && shDegree === entries[key].shDegree;
    if (key !== i && !(key === entries[i - 1]?.key && isLikeKey))
      fail(`frame ${i} cannot be the difference to frame ${key}`, at);
    const columns = columnCountOf(entry.shDegree);
    const head = key === i ? keyHeadBytes(splatCount) : 0;
    const isPossible =
      unpackedBytes >= head + columns && unpackedBytes <= head + columns * (1 + 4 * splatCount);
    if (!isPossible) fail(`frame ${i} unpacks to ${unpackedBytes} bytes, which its splats cannot take`, at);
    entries.push(entry);
    next = offset + entry.bytes;
  }
  const flags = view.getUint8(HEADER.flags);
  const isAntialiased = flags & TELLS_ANTIALIASED ? (flags & IS_ANTIALIASED) !== 0 : undefined;
  return { framesPerS, isAntialiased, entries };
}

/** What a file states about itself. */
export function factsOf({ entries, framesPerS: perS }: FramesHeader) {
  const { offset, bytes } = entries[entries.length - 1];
  return { format: 'frames', frames: { count: entries.length, perS, bytes: offset + bytes } };
}

/**
 * Checks that the splats of a frame take no more memory than a file of this size may.
 *
 * @throws SplatFileError 'too-large'
 */
export function checkUnpacked({ splatCount, shDegree }: FrameEntry, file: string, limitBytes: number): void {
  const bytes = 4 * rowLength(shDegree) * splatCount;
  if (bytes <= limitBytes) return;
  const message = `the ${splatCount} splats of a frame take ${bytes} bytes unpacked, and ${limitBytes} are the limit. Pass a larger maxBytes if that is right.`;
  throw new SplatFileError('too-large', file, message, { byte: HEADER_BYTES });
}
