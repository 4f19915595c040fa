// Reads lossless WebP images (VP8L). "Sections" in comments are of RFC 9649, from section 3 on.
import {
  average,
  blocks,
  CACHE_FACTOR,
  CODE_LENGTH_ORDER,
  clampedHalf,
  clampedSum,
  DISTANCE_CODES,
  distanceTo,
  LENGTH_CODES,
  MAX_CACHE_BITS,
  MAX_CODE_LENGTH,
  NEIGHBOURS,
  SIGNATURE,
  select,
  TRANSFORM,
} from './vp8l-format.ts';

/** The bytes are not a valid lossless image; `decodeWebp` converts it to a SplatFileError. */
export class Vp8lError extends Error {
  override readonly name = 'Vp8lError';
}

export interface ImageSize {
  readonly width: number;
  readonly height: number;
}

/** Bytes before the coded image: signature, width, height, alpha hint, version. */
const HEADER_BYTES = 5;
/** Positions in bits must fit into an int32. */
const MAX_BYTES = 2 ** 28 - 16;

/** Codes of at most this many bits take a single table look-up. */
const ROOT_BITS = 8;
/** Most table entries per image. Encoders need far fewer; a few malicious bits could demand many. */
const MAX_TABLE_ENTRIES = 2 ** 23;

/**
 * Size of a lossless image.
 *
 * @throws Vp8lError
 */
export function vp8lSize(data: Uint8Array): ImageSize {
  if (data.length < HEADER_BYTES) throw new Vp8lError('it ends within its header');
  if (data[0] !== SIGNATURE) throw new Vp8lError('its signature is wrong');
  const bits = data[1] | (data[2] << 8) | (data[3] << 16) | (data[4] << 24);
  if (bits >>> 29 !== 0) throw new Vp8lError(`its version is ${bits >>> 29}, not 0`);
  return { width: (bits & 0x3fff) + 1, height: ((bits >>> 14) & 0x3fff) + 1 };
}

/**
 * Decodes a lossless image: R, G, B, A of each pixel, row by row from the top left.
 *
 * @throws Vp8lError
 */
export function decodeVp8l(data: Uint8Array): Uint8Array<ArrayBuffer> {
  const { width, height } = vp8lSize(data);
  if (data.length > MAX_BYTES) throw new Vp8lError(`it has more than ${MAX_BYTES} bytes`);
  const bits = new BitReader(data);
  bits.position = 8 * HEADER_BYTES;
  try {
    const argb = decodeTransformed(bits, width, height);
    bits.checkEnd();
    return toRgba(argb);
  } catch (error) {
    if (error instanceof RangeError) throw new Vp8lError('it ends too early');
    // Reads past the end return zeros, so truncation may first look like another fault.
    bits.checkEnd();
    throw error;
  }
}

/** Reads bits from the lowest of each byte on. Reading far past the end throws a RangeError. */
class BitReader {
  /** Index of the next bit. */
  position = 0;
  readonly view: DataView;
  readonly #endPosition: number;

  constructor(data: Uint8Array) {
    this.#endPosition = 8 * data.length;
    // Padding, because four bytes are read at any position before the end.
    const padded = new Uint8Array(data.length + 8);
    padded.set(data);
    this.view = new DataView(padded.buffer);
  }

  /** @param count up to 25. */
  read(count: number): number {
    const window = this.view.getInt32(this.position >>> 3, true) >>> (this.position & 7);
    this.position += count;
    return window & ((1 << count) - 1);
  }

  checkEnd(): void {
    if (this.position > this.#endPosition) throw new Vp8lError('it ends too early');
  }
}

/** Lookup tables of prefix codes, concatenated in one array. */
class Tables {
  /**
   * Entry for the next bits: symbol × 16 + code length. If the code is longer than ROOT_BITS: −1 −
   * (index of a second table × 16 + bits of that table).
   */
  entries = new Int32Array(1 << 12);
  #length = 0;

  /** Reserves `count` entries and returns the index of the first. */
  allocate(count: number): number {
    const start = this.#length;
    this.#length += count;
    if (this.#length > MAX_TABLE_ENTRIES) throw new Vp8lError('its prefix codes take too much memory');
    if (this.#length > this.entries.length) {
      const larger = new Int32Array(Math.max(this.#length, 2 * this.entries.length));
      larger.set(this.entries);
      this.entries = larger;
    }
    return start;
  }
}

/** Location of a prefix code's table, and the bits of its first look-up. */
interface PrefixCode {
  readonly table: number;
  readonly mask: number;
}

/** The five prefix codes of a region (section 3.7.2.2). */
interface CodeGroup {
  readonly green: PrefixCode;
  readonly red: PrefixCode;
  readonly blue: PrefixCode;
  readonly alpha: PrefixCode;
  readonly distance: PrefixCode;
}

interface Transform {
  readonly type: number;
  /** Log2 of the side of a block, or of the number of pixels packed into one. */
  readonly bits: number;
  /** Width of the image after the inverse transform, in pixels. */
  readonly width: number;
  readonly data: Int32Array;
}

function decodeTransformed(bits: BitReader, width: number, height: number): Int32Array<ArrayBuffer> {
  const transforms: Transform[] = [];
  let codedWidth = width;
  while (bits.read(1) === 1) {
    const transform = readTransform(bits, codedWidth, height);
    if (transforms.some(({ type }) => type === transform.type))
      throw new Vp8lError('it has a transform twice');
    transforms.push(transform);
    if (transform.type === TRANSFORM.colorIndexing) codedWidth = blocks(codedWidth, transform.bits);
  }
  let argb = decodePixels(bits, codedWidth, height, true);
  for (const transform of transforms.reverse()) {
    if (transform.type === TRANSFORM.predictor) addPredictions(argb, transform, height);
    else if (transform.type === TRANSFORM.crossColor) addCrossColor(argb, transform, height);
    else if (transform.type === TRANSFORM.subtractGreen) addGreen(argb);
    else argb = lookUpColors(argb, transform, height);
  }
  return argb;
}

function readTransform(bits: BitReader, width: number, height: number): Transform {
  const type = bits.read(2);
  if (type === TRANSFORM.subtractGreen) return { type, bits: 0, width, data: new Int32Array(0) };
  if (type === TRANSFORM.colorIndexing) {
    const count = bits.read(8) + 1;
    const data = decodePixels(bits, count, 1, false);
    // Each is stored as its difference from the predecessor.
    for (let i = 1; i < count; i++) data[i] = addPixels(data[i], data[i - 1]);
    return { type, bits: count <= 2 ? 3 : count <= 4 ? 2 : count <= 16 ? 1 : 0, width, data };
  }
  const sizeBits = bits.read(3) + 2;
  const data = decodePixels(bits, blocks(width, sizeBits), blocks(height, sizeBits), false);
  return { type, bits: sizeBits, width, data };
}

/** Decodes an entropy-coded image (section 3.6) to ARGB; only the main image has several groups. */
function decodePixels(
  bits: BitReader,
  width: number,
  height: number,
  isMain: boolean,
): Int32Array<ArrayBuffer> {
  const cacheBits = bits.read(1) === 1 ? bits.read(4) : 0;
  if (cacheBits > MAX_CACHE_BITS) throw new Vp8lError(`its colour cache has ${cacheBits} bits`);
  let blockBits = 0;
  let groupOfBlock: Int32Array | null = null;
  let groupCount = 1;
  if (isMain && bits.read(1) === 1) {
    blockBits = bits.read(3) + 2;
    groupOfBlock = decodePixels(bits, blocks(width, blockBits), blocks(height, blockBits), false);
    for (let i = 0; i < groupOfBlock.length; i++) {
      const group = (groupOfBlock[i] >>> 8) & 0xffff;
      groupOfBlock[i] = group;
      if (group >= groupCount) groupCount = group + 1;
    }
  }
  const tables = new Tables();
  const lengths = new Uint8Array(256 + LENGTH_CODES + (1 << MAX_CACHE_BITS));
  const groups: CodeGroup[] = [];
  while (groups.length < groupCount) {
    const greenCodes = 256 + LENGTH_CODES + (cacheBits > 0 ? 1 << cacheBits : 0);
    groups.push({
      green: readCode(bits, tables, lengths.subarray(0, greenCodes)),
      red: readCode(bits, tables, lengths.subarray(0, 256)),
      blue: readCode(bits, tables, lengths.subarray(0, 256)),
      alpha: readCode(bits, tables, lengths.subarray(0, 256)),
      distance: readCode(bits, tables, lengths.subarray(0, DISTANCE_CODES)),
    });
    bits.checkEnd();
  }
  // Allocated only after all headers were valid.
  const pixels = pixelMemory(width * height);
  readPixels(bits, pixels, width, tables.entries, groups, groupOfBlock, blockBits, cacheBits);
  return pixels;
}

function pixelMemory(count: number): Int32Array<ArrayBuffer> {
  try {
    return new Int32Array(count);
  } catch {
    throw new Vp8lError(`there is no memory for ${count} pixels`);
  }
}

function readPixels(
  bits: BitReader,
  pixels: Int32Array,
  width: number,
  entries: Int32Array,
  groups: readonly CodeGroup[],
  groupOfBlock: Int32Array | null,
  blockBits: number,
  cacheBits: number,
): void {
  const { view } = bits;
  const cache = cacheBits > 0 ? new Int32Array(1 << cacheBits) : null;
  const cacheShift = 32 - cacheBits;
  const blocksPerRow = blocks(width, blockBits);
  const blockMask = groupOfBlock ? (1 << blockBits) - 1 : -1;
  const count = pixels.length;
  let { green, red, blue, alpha, distance } = groups[0];
  let position = bits.position;
  let x = 0;
  let y = 0;
  /** Number of pixels already in the colour cache. */
  let cached = 0;
  for (let at = 0; at < count; ) {
    if ((x & blockMask) === 0 && groupOfBlock) {
      const group = groups[groupOfBlock[(y >> blockBits) * blocksPerRow + (x >> blockBits)]];
      ({ green, red, blue, alpha, distance } = group);
    }
    let window = view.getInt32(position >>> 3, true) >>> (position & 7);
    let entry = entries[green.table + (window & green.mask)];
    if (entry < 0) entry = longEntry(entries, entry, window);
    position += entry & 15;
    const symbol = entry >> 4;
    if (symbol < 256) {
      window = view.getInt32(position >>> 3, true) >>> (position & 7);
      entry = entries[red.table + (window & red.mask)];
      if (entry < 0) entry = longEntry(entries, entry, window);
      position += entry & 15;
      let argb = ((entry >> 4) << 16) | (symbol << 8);
      window = view.getInt32(position >>> 3, true) >>> (position & 7);
      entry = entries[blue.table + (window & blue.mask)];
      if (entry < 0) entry = longEntry(entries, entry, window);
      position += entry & 15;
      argb |= entry >> 4;
      window = view.getInt32(position >>> 3, true) >>> (position & 7);
      entry = entries[alpha.table + (window & alpha.mask)];
      if (entry < 0) entry = longEntry(entries, entry, window);
      position += entry & 15;
      pixels[at++] = argb | ((entry >> 4) << 24);
      if (++x === width) {
        x = 0;
        y++;
      }
    } else if (symbol < 256 + LENGTH_CODES) {
      bits.position = position;
      const length = readLength(bits, symbol - 256);
      window = view.getInt32(bits.position >>> 3, true) >>> (bits.position & 7);
      entry = entries[distance.table + (window & distance.mask)];
      if (entry < 0) entry = longEntry(entries, entry, window);
      bits.position += entry & 15;
      const from = at - distanceOf(readLength(bits, entry >> 4), width);
      position = bits.position;
      if (from < 0 || length > count - at) throw new Vp8lError('it copies pixels from outside of it');
      for (let i = 0; i < length; i++) pixels[at + i] = pixels[from + i];
      at += length;
      x += length;
      while (x >= width) {
        x -= width;
        y++;
      }
      // Within a block, the group stays the same.
      if (groupOfBlock && (x & blockMask) !== 0 && at < count) {
        const group = groups[groupOfBlock[(y >> blockBits) * blocksPerRow + (x >> blockBits)]];
        ({ green, red, blue, alpha, distance } = group);
      }
    } else {
      for (; cached < at; cached++)
        cache![Math.imul(CACHE_FACTOR, pixels[cached]) >>> cacheShift] = pixels[cached];
      pixels[at++] = cache![symbol - 256 - LENGTH_CODES];
      if (++x === width) {
        x = 0;
        y++;
      }
    }
  }
  bits.position = position;
}

/** Look-up of a code longer than ROOT_BITS; `entry` refers to the second table. */
function longEntry(entries: Int32Array, entry: number, window: number): number {
  const second = -1 - entry;
  return entries[(second >> 4) + ((window >>> ROOT_BITS) & ((1 << (second & 15)) - 1))];
}

/** Reads a length or distance code (section 3.6.2.2). */
function readLength(bits: BitReader, symbol: number): number {
  if (symbol < 4) return symbol + 1;
  const extraBits = (symbol - 2) >> 1;
  return ((2 + (symbol & 1)) << extraBits) + bits.read(extraBits) + 1;
}

/** Distance in pixels, in scan order. */
function distanceOf(code: number, width: number): number {
  if (code > NEIGHBOURS.length) return code - NEIGHBOURS.length;
  return distanceTo(NEIGHBOURS[code - 1], width);
}

/** Reads a prefix code; the alphabet has `lengths.length` symbols (section 3.7.2.1). */
function readCode(bits: BitReader, tables: Tables, lengths: Uint8Array): PrefixCode {
  lengths.fill(0);
  if (bits.read(1) === 1) {
    const symbols = bits.read(1) + 1;
    const first = bits.read(bits.read(1) === 1 ? 8 : 1);
    const second = symbols === 2 ? bits.read(8) : first;
    if (first >= lengths.length || second >= lengths.length)
      throw new Vp8lError('a prefix code has a symbol that its alphabet lacks');
    lengths[first] = 1;
    lengths[second] = 1;
  } else readLengths(bits, lengths);
  return buildTable(tables, lengths);
}

function readLengths(bits: BitReader, lengths: Uint8Array): void {
  const lengthLengths = new Uint8Array(CODE_LENGTH_ORDER.length);
  const lengthCount = 4 + bits.read(4);
  for (let i = 0; i < lengthCount; i++) lengthLengths[CODE_LENGTH_ORDER[i]] = bits.read(3);
  const lengthTables = new Tables();
  const { table, mask } = buildTable(lengthTables, lengthLengths);
  let left = lengths.length;
  if (bits.read(1) === 1) {
    left = 2 + bits.read(2 + 2 * bits.read(3));
    if (left > lengths.length) throw new Vp8lError('a prefix code has more symbols than its alphabet');
  }
  let previous = 8;
  for (let symbol = 0; symbol < lengths.length && left > 0; left--) {
    const window = bits.view.getInt32(bits.position >>> 3, true) >>> (bits.position & 7);
    // Codes of code lengths have at most 7 bits.
    const entry = lengthTables.entries[table + (window & mask)];
    bits.position += entry & 15;
    const code = entry >> 4;
    if (code < 16) {
      lengths[symbol++] = code;
      if (code !== 0) previous = code;
      continue;
    }
    const repeats = code === 16 ? 3 + bits.read(2) : code === 17 ? 3 + bits.read(3) : 11 + bits.read(7);
    if (symbol + repeats > lengths.length)
      throw new Vp8lError('a prefix code has more symbols than its alphabet');
    if (code === 16) lengths.fill(previous, symbol, symbol + repeats);
    symbol += repeats;
  }
}

/** Builds the look-up table of a canonical prefix code from the code length of each symbol. */
function buildTable(tables: Tables, lengths: Uint8Array): PrefixCode {
  const countOf = new Int32Array(MAX_CODE_LENGTH + 1);
  let last = 0;
  for (let symbol = 0; symbol < lengths.length; symbol++) {
    if (lengths[symbol] === 0) continue;
    countOf[lengths[symbol]]++;
    last = symbol;
  }
  countOf[0] = 0;
  let used = 0;
  let longest = 0;
  /** Number of unused codes of the current length. */
  let open = 1;
  for (let length = 1; length <= MAX_CODE_LENGTH; length++) {
    open = 2 * open - countOf[length];
    if (open < 0) throw new Vp8lError('a prefix code has too many codes');
    if (countOf[length] === 0) continue;
    used += countOf[length];
    longest = length;
  }
  if (used === 1) {
    // A single symbol takes no bits.
    const table = tables.allocate(1);
    tables.entries[table] = last << 4;
    return { table, mask: 0 };
  }
  if (open !== 0) throw new Vp8lError('a prefix code is incomplete');

  // Symbols in the order of their codes: by length, then by number.
  const startOf = new Int32Array(MAX_CODE_LENGTH + 2);
  for (let length = 1; length <= MAX_CODE_LENGTH; length++)
    startOf[length + 1] = startOf[length] + countOf[length];
  const symbols = new Int32Array(used);
  for (let symbol = 0; symbol < lengths.length; symbol++)
    if (lengths[symbol] > 0) symbols[startOf[lengths[symbol]]++] = symbol;

  const rootBits = Math.min(longest, ROOT_BITS);
  const mask = (1 << rootBits) - 1;
  const table = tables.allocate(1 << rootBits);
  let second = 0;
  let secondBits = 0;
  let secondRoot = -1;
  /** The bit-reversed code: its first bit is the lowest. */
  let reversed = 0;
  let next = 0;
  for (let length = 1; length <= longest; length++) {
    for (let left = countOf[length]; left > 0; left--) {
      const entry = (symbols[next++] << 4) | length;
      if (length <= rootBits) {
        for (let i = reversed; i <= mask; i += 1 << length) tables.entries[table + i] = entry;
      } else {
        const root = reversed & mask;
        if (root !== secondRoot) {
          secondBits = secondTableBits(countOf, length, left, rootBits);
          second = tables.allocate(1 << secondBits);
          tables.entries[table + root] = -1 - ((second << 4) | secondBits);
          secondRoot = root;
        }
        for (let i = reversed >> rootBits; i < 1 << secondBits; i += 1 << (length - rootBits))
          tables.entries[second + i] = entry;
      }
      reversed = nextReversed(reversed, length);
    }
  }
  return { table, mask };
}

/** Bits of the second table that begins with a code of `length`, of which `left` codes remain. */
function secondTableBits(countOf: Int32Array, length: number, left: number, rootBits: number): number {
  let bits = length - rootBits;
  let open = (1 << bits) - left;
  while (open > 0 && length < MAX_CODE_LENGTH) {
    length++;
    bits++;
    open = 2 * open - countOf[length];
  }
  return bits;
}

/** The next bit-reversed code of `length` bits: adds one at the highest bit. */
function nextReversed(reversed: number, length: number): number {
  let bit = 1 << (length - 1);
  while ((reversed & bit) !== 0) bit >>= 1;
  return bit === 0 ? 0 : (reversed & (bit - 1)) | bit;
}

/** Adds each channel modulo 256. */
function addPixels(a: number, b: number): number {
  return (
    (((a & 0xff00ff00) + (b & 0xff00ff00)) & 0xff00ff00) |
    (((a & 0x00ff00ff) + (b & 0x00ff00ff)) & 0x00ff00ff)
  );
}

/** Inverse predictor transform (section 3.5.1). */
function addPredictions(argb: Int32Array, { bits, width, data }: Transform, height: number): void {
  argb[0] = addPixels(argb[0], 0xff000000);
  for (let x = 1; x < width; x++) argb[x] = addPixels(argb[x], argb[x - 1]);
  const blocksPerRow = blocks(width, bits);
  for (let y = 1; y < height; y++) {
    const row = y * width;
    argb[row] = addPixels(argb[row], argb[row - width]);
    const blockRow = (y >> bits) * blocksPerRow;
    for (let x = 1; x < width; ) {
      const end = Math.min(width, ((x >> bits) + 1) << bits);
      const mode = (data[blockRow + (x >> bits)] >> 8) & 15;
      addPredictionsIn(argb, row + x, row + end, width, mode);
      x = end;
    }
  }
}

/** Adds predictions to the pixels from `from` to before `to`, within one row and block. */
function addPredictionsIn(argb: Int32Array, from: number, to: number, width: number, mode: number): void {
  let left = argb[from - 1];
  // One loop per mode: a switch per pixel takes longer than most predictions.
  switch (mode) {
    case 1:
      for (let i = from; i < to; i++) argb[i] = left = addPixels(argb[i], left);
      break;
    case 2:
      for (let i = from; i < to; i++) argb[i] = addPixels(argb[i], argb[i - width]);
      break;
    case 3:
      for (let i = from; i < to; i++) argb[i] = addPixels(argb[i], argb[i - width + 1]);
      break;
    case 4:
      for (let i = from; i < to; i++) argb[i] = addPixels(argb[i], argb[i - width - 1]);
      break;
    case 5:
      for (let i = from; i < to; i++)
        argb[i] = left = addPixels(argb[i], average(average(left, argb[i - width + 1]), argb[i - width]));
      break;
    case 6:
      for (let i = from; i < to; i++) argb[i] = left = addPixels(argb[i], average(left, argb[i - width - 1]));
      break;
    case 7:
      for (let i = from; i < to; i++) argb[i] = left = addPixels(argb[i], average(left, argb[i - width]));
      break;
    case 8:
      for (let i = from; i < to; i++)
        argb[i] = addPixels(argb[i], average(argb[i - width - 1], argb[i - width]));
      break;
    case 9:
      for (let i = from; i < to; i++)
        argb[i] = addPixels(argb[i], average(argb[i - width], argb[i - width + 1]));
      break;
    case 10:
      for (let i = from; i < to; i++) {
        const top = i - width;
        const prediction = average(average(left, argb[top - 1]), average(argb[top], argb[top + 1]));
        argb[i] = left = addPixels(argb[i], prediction);
      }
      break;
    case 11:
      for (let i = from; i < to; i++) {
        const top = i - width;
        argb[i] = left = addPixels(argb[i], select(left, argb[top], argb[top - 1]));
      }
      break;
    case 12:
      for (let i = from; i < to; i++) {
        const top = i - width;
        argb[i] = left = addPixels(argb[i], clampedSum(left, argb[top], argb[top - 1]));
      }
      break;
    case 13:
      for (let i = from; i < to; i++) {
        const top = i - width;
        argb[i] = left = addPixels(argb[i], clampedHalf(average(left, argb[top]), argb[top - 1]));
      }
      break;
    default:
      for (let i = from; i < to; i++) argb[i] = addPixels(argb[i], 0xff000000);
  }
}

/** Inverse colour transform (section 3.5.2). */
function addCrossColor(argb: Int32Array, { bits, width, data }: Transform, height: number): void {
  const blocksPerRow = blocks(width, bits);
  for (let y = 0; y < height; y++) {
    const row = y * width;
    const blockRow = (y >> bits) * blocksPerRow;
    for (let x = 0; x < width; ) {
      const end = Math.min(width, ((x >> bits) + 1) << bits);
      const factors = data[blockRow + (x >> bits)];
      const greenToRed = (factors << 24) >> 24;
      const greenToBlue = (factors << 16) >> 24;
      const redToBlue = (factors << 8) >> 24;
      for (; x < end; x++) {
        const pixel = argb[row + x];
        const green = (pixel << 16) >> 24;
        const red = (pixel >> 16) + ((greenToRed * green) >> 5);
        const blue = pixel + ((greenToBlue * green) >> 5) + ((redToBlue * ((red << 24) >> 24)) >> 5);
        argb[row + x] = (pixel & 0xff00ff00) | ((red & 255) << 16) | (blue & 255);
      }
    }
  }
}

/** Inverse subtract-green transform (section 3.5.3). */
function addGreen(argb: Int32Array): void {
  for (let i = 0; i < argb.length; i++) {
    const pixel = argb[i];
    const green = (pixel >>> 8) & 255;
    argb[i] = (pixel & 0xff00ff00) | (((pixel & 0x00ff00ff) + ((green << 16) | green)) & 0x00ff00ff);
  }
}

/** Inverse colour-indexing transform (section 3.5.4). */
function lookUpColors(
  indices: Int32Array,
  { bits, width, data }: Transform,
  height: number,
): Int32Array<ArrayBuffer> {
  // Indices beyond the table are transparent black.
  const colors = new Int32Array(256);
  colors.set(data);
  const argb = pixelMemory(width * height);
  const packedWidth = blocks(width, bits);
  const bitsEach = 8 >> bits;
  const mask = (1 << bitsEach) - 1;
  const withinMask = (1 << bits) - 1;
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const packed = (indices[y * packedWidth + (x >> bits)] >>> 8) & 255;
      argb[y * width + x] = colors[(packed >> ((x & withinMask) * bitsEach)) & mask];
    }
  }
  return argb;
}

/** Converts to R, G, B, A in place, and returns the pixels as bytes. */
export function toRgba(argb: Int32Array<ArrayBuffer>): Uint8Array<ArrayBuffer> {
  for (let i = 0; i < argb.length; i++) {
    const pixel = argb[i];
    argb[i] = (pixel & 0xff00ff00) | ((pixel >>> 16) & 255) | ((pixel & 255) << 16);
  }
  return new Uint8Array(argb.buffer);
}
