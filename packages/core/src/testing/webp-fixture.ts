// Writes lossless WebP images for tests, with the features of the format that a test chooses.

/** A pixel as A, R, G, B in one number; pixels that are copied; or one of the colour cache. */
export type Item =
  | number
  | { readonly length: number; readonly distanceCode: number }
  | { readonly cached: number };

/** Lengths of a code's symbols, or its one or two symbols. */
export type Code = readonly number[] | { readonly symbols: readonly [number] | readonly [number, number] };

export interface CodedImage {
  readonly items: readonly Item[];
  readonly cacheBits?: number;
  /** Of red, green, blue, alpha and distances, for each group; flat codes by default. */
  readonly groups?: readonly Partial<Record<'green' | 'red' | 'blue' | 'alpha' | 'distance', Code>>[];
  /** Of a main image: which group each block has, from the items' first pixel on. */
  readonly blocks?: { readonly bits: number; readonly width: number; readonly groups: readonly number[] };
}

export type FixtureTransform =
  | { readonly type: 'predictor' | 'cross-color'; readonly bits: number; readonly image: CodedImage }
  | { readonly type: 'subtract-green' }
  | { readonly type: 'color-indexing'; readonly size: number; readonly image: CodedImage };

/** Codes for `count` symbols, all as long as can be. */
export function flatCode(count: number): number[] {
  const bits = Math.floor(Math.log2(count));
  const short = 2 ** (bits + 1) - count;
  return Array.from({ length: count }, (_, symbol) => (symbol < short ? bits : bits + 1));
}

/** Codes of 1, 2, … 6 bits, and others of up to 15. */
export function steepCode(count: number): number[] {
  return [1, 2, 3, 4, 5, 6, ...flatCode(count - 6).map((length) => length + 6)];
}

export class BitWriter {
  readonly #bytes: number[] = [];
  #bit = 0;

  write(value: number, count: number): void {
    for (let i = 0; i < count; i++) {
      if (this.#bit === 0) this.#bytes.push(0);
      this.#bytes[this.#bytes.length - 1] |= ((value >>> i) & 1) << this.#bit;
      this.#bit = (this.#bit + 1) % 8;
    }
  }

  finish(): Uint8Array<ArrayBuffer> {
    return Uint8Array.from(this.#bytes);
  }
}

/** The chunk of a lossless image. Transforms are in the order of the file. */
export function vp8lBytes(
  width: number,
  height: number,
  image: CodedImage,
  transforms: readonly FixtureTransform[] = [],
): Uint8Array<ArrayBuffer> {
  const bits = new BitWriter();
  bits.write(0x2f, 8);
  bits.write(width - 1, 14);
  bits.write(height - 1, 14);
  bits.write(1, 1);
  bits.write(0, 3);
  for (const transform of transforms) {
    bits.write(1, 1);
    bits.write(['predictor', 'cross-color', 'subtract-green', 'color-indexing'].indexOf(transform.type), 2);
    if (transform.type === 'subtract-green') continue;
    if (transform.type === 'color-indexing') bits.write(transform.size - 1, 8);
    else bits.write(transform.bits - 2, 3);
    writeImage(bits, transform.image, false);
  }
  bits.write(0, 1);
  writeImage(bits, image, true);
  return bits.finish();
}

/** A file with the image. */
export function webpBytes(image: Uint8Array, kind = 'VP8L'): Uint8Array<ArrayBuffer> {
  const padded = image.length + (image.length & 1);
  const bytes = new Uint8Array(20 + padded);
  const view = new DataView(bytes.buffer);
  const text = (value: string, at: number) =>
    bytes.set(
      Uint8Array.from(value, (each) => each.charCodeAt(0)),
      at,
    );
  text('RIFF', 0);
  view.setUint32(4, bytes.length - 8, true);
  text('WEBP', 8);
  text(kind, 12);
  view.setUint32(16, image.length, true);
  bytes.set(image, 20);
  return bytes;
}

/** A lossless image of R, G, B, A bytes. */
export function rgbaWebp(width: number, height: number, rgba: Uint8Array): Uint8Array<ArrayBuffer> {
  const items = Array.from({ length: width * height }, (_, i) => {
    const [r, g, b, a] = rgba.subarray(4 * i, 4 * i + 4);
    return ((a << 24) | (r << 16) | (g << 8) | b) >>> 0;
  });
  return webpBytes(vp8lBytes(width, height, { items }));
}

function writeImage(
  bits: BitWriter,
  { items, cacheBits = 0, groups = [{}], blocks }: CodedImage,
  isMain: boolean,
): void {
  bits.write(cacheBits > 0 ? 1 : 0, 1);
  if (cacheBits > 0) bits.write(cacheBits, 4);
  if (isMain) {
    bits.write(blocks ? 1 : 0, 1);
    if (blocks) {
      bits.write(blocks.bits - 2, 3);
      writeImage(bits, { items: blocks.groups.map((group) => group << 8) }, false);
    }
  }
  const greenCount = 280 + (cacheBits > 0 ? 2 ** cacheBits : 0);
  const encoders = groups.map(({ green, red, blue, alpha, distance }) => ({
    green: writeCode(bits, green ?? flatCode(greenCount)),
    red: writeCode(bits, red ?? flatCode(256)),
    blue: writeCode(bits, blue ?? flatCode(256)),
    alpha: writeCode(bits, alpha ?? flatCode(256)),
    distance: writeCode(bits, distance ?? flatCode(40)),
  }));
  let pixel = 0;
  for (const item of items) {
    const column = blocks ? pixel % blocks.width : 0;
    const row = blocks ? Math.floor(pixel / blocks.width) : 0;
    const perRow = blocks ? Math.ceil(blocks.width / 2 ** blocks.bits) : 0;
    const block = blocks ? (row >> blocks.bits) * perRow + (column >> blocks.bits) : 0;
    const encode = encoders[blocks?.groups[block] ?? 0];
    if (typeof item === 'number') {
      encode.green((item >>> 8) & 255);
      encode.red((item >>> 16) & 255);
      encode.blue(item & 255);
      encode.alpha(item >>> 24);
      pixel++;
    } else if ('cached' in item) {
      encode.green(280 + item.cached);
      pixel++;
    } else {
      writeLength(bits, item.length, (symbol) => encode.green(256 + symbol));
      writeLength(bits, item.distanceCode, encode.distance);
      pixel += item.length;
    }
  }
}

function writeLength(bits: BitWriter, value: number, encode: (symbol: number) => void): void {
  if (value <= 4) {
    encode(value - 1);
    return;
  }
  const extraBits = Math.floor(Math.log2(value - 1)) - 1;
  const offset = value - 1 - (2 << extraBits);
  const half = offset >> extraBits;
  encode(2 * extraBits + 2 + half);
  bits.write(offset - (half << extraBits), extraBits);
}

/** Writes a code and returns the function that writes its symbols. */
function writeCode(bits: BitWriter, code: Code): (symbol: number) => void {
  if ('symbols' in code) {
    const [first, second] = code.symbols;
    bits.write(1, 1);
    bits.write(second === undefined ? 0 : 1, 1);
    bits.write(1, 1);
    bits.write(first, 8);
    if (second === undefined) return () => {};
    bits.write(second, 8);
    const [low] = [first, second].sort((a, b) => a - b);
    return (symbol) => bits.write(symbol === low ? 0 : 1, 1);
  }
  bits.write(0, 1);
  bits.write(15, 4);
  // Each length 0 to 15 by 4 bits, and no repeats.
  for (const symbol of [17, 18, 0, 1, 2, 3, 4, 5, 16, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15])
    bits.write(symbol < 16 ? 4 : 0, 3);
  bits.write(0, 1);
  for (const length of code) writeReversed(bits, length, 4);
  const codes = canonicalCodes(code);
  return (symbol) => writeReversed(bits, codes[symbol], code[symbol]);
}

function writeReversed(bits: BitWriter, value: number, count: number): void {
  for (let i = count - 1; i >= 0; i--) bits.write(value >>> i, 1);
}

function canonicalCodes(lengths: readonly number[]): number[] {
  const codes: number[] = [];
  let next = 0;
  for (let length = 1; length <= 15; length++) {
    for (let symbol = 0; symbol < lengths.length; symbol++)
      if (lengths[symbol] === length) codes[symbol] = next++;
    next *= 2;
  }
  return codes;
}
