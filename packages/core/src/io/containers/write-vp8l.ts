// Writes lossless WebP images (VP8L). "Sections" in comments are of RFC 9649, from section 3 on.
import type { Turns } from '../../data/turns.ts';
import { codeLengths, codesOf } from './huffman-lengths.ts';
import { copiesOf, type Items, singlePixels } from './vp8l-copies.ts';
import {
  blocks,
  CACHE_FACTOR,
  CODE_LENGTH_ORDER,
  DISTANCE_CODES,
  LENGTH_CODES,
  MAX_CODE_LENGTH,
  SIGNATURE,
  TRANSFORM,
} from './vp8l-format.ts';
import { PREDICTOR_BITS, predict, withoutGreen } from './vp8l-predict.ts';

/** Largest width and height. */
export const MAX_SIDE_PX = 2 ** 14;

/** Colour cache sizes that are tried, in bits. */
const CACHE_BITS = [0, 2, 5, 8, 10];
/** Longest code of a code length (section 3.7.2.1.2). */
const MAX_LENGTH_LENGTH = 7;
const GREEN_CODES = 256 + LENGTH_CODES;

/**
 * Encodes an image. It chooses the transforms of lossless WebP with the fewest estimated bits, and
 * copies repeated pixels. Equal images give equal bytes.
 *
 * @param rgba R, G, B, A of each pixel, row by row from the top left.
 * @param width in pixels, 1 to MAX_SIDE_PX; likewise `height`.
 */
export async function encodeVp8l(
  width: number,
  height: number,
  rgba: Uint8Array,
  turns: Turns,
): Promise<Uint8Array<ArrayBuffer>> {
  const plain = new Int32Array(width * height);
  let isOpaque = true;
  for (let i = 0; i < plain.length; i++) {
    plain[i] = (rgba[4 * i + 3] << 24) | (rgba[4 * i] << 16) | (rgba[4 * i + 1] << 8) | rgba[4 * i + 2];
    isOpaque &&= rgba[4 * i + 3] === 255;
  }
  await turns.give();
  const bits = new BitWriter();
  bits.write(SIGNATURE, 8);
  bits.write(width - 1, 14);
  bits.write(height - 1, 14);
  bits.write(isOpaque ? 0 : 1, 1);
  bits.write(0, 3);

  const greenless = withoutGreen(plain);
  const hasGreen = entropyOf(plain) <= entropyOf(greenless);
  const colors = hasGreen ? plain : greenless;
  if (!hasGreen) {
    bits.write(1, 1);
    bits.write(TRANSFORM.subtractGreen, 2);
  }
  await turns.give();
  const { modes, rest } = await predict(colors, width, turns);
  const plan = await planOf(colors, width, turns);
  const restPlan = await planOf(rest, width, turns);
  const modesWidth = blocks(width, PREDICTOR_BITS);
  const modesPlan = await planOf(modes, modesWidth, turns);
  const isPredicted = restPlan.cost + modesPlan.cost < plan.cost;
  if (isPredicted) {
    bits.write(1, 1);
    bits.write(TRANSFORM.predictor, 2);
    bits.write(PREDICTOR_BITS - 2, 3);
    await writePixels(bits, modes, modesPlan, false, turns);
  }
  bits.write(0, 1);
  await writePixels(bits, isPredicted ? rest : colors, isPredicted ? restPlan : plan, true, turns);
  return bits.finish();
}

/** The cheapest plan found. */
async function planOf(pixels: Int32Array, width: number, turns: Turns): Promise<Plan> {
  const pixelBits = entropyOf(pixels) / pixels.length;
  let best: Plan | null = null;
  // A colour cache may take fewer bits than copies.
  for (const items of [singlePixels(pixels.length), await copiesOf(pixels, width, pixelBits, turns)]) {
    for (const cacheBits of CACHE_BITS) {
      const plan: Plan = new Plan(pixels, items, cacheBits);
      if (!best || plan.cost < best.cost) best = plan;
      await turns.give();
    }
  }
  return best!;
}

/** Writes an entropy-coded image (section 3.6), with one group of codes. */
async function writePixels(
  bits: BitWriter,
  pixels: Int32Array,
  { items, cacheBits, green, red, blue, alpha, distance }: Plan,
  isMain: boolean,
  turns: Turns,
): Promise<void> {
  bits.write(cacheBits > 0 ? 1 : 0, 1);
  if (cacheBits > 0) bits.write(cacheBits, 4);
  if (isMain) bits.write(0, 1);
  const codes = [green, red, blue, alpha, distance].map((counts) => new PrefixCode(bits, counts));
  const [greens, reds, blues, alphas, distances] = codes;
  const cache = new ColorCache(cacheBits);
  const { lengths, distanceCodes, count } = items;
  let pixel = 0;
  for (let i = 0; i < count; i++) {
    if (i % 8192 === 0) await turns.give();
    if (distanceCodes[i] > 0) {
      writeLength(bits, lengths[i], 256, greens);
      writeLength(bits, distanceCodes[i], 0, distances);
      for (const end = pixel + lengths[i]; pixel < end; pixel++) cache.add(pixels[pixel]);
      continue;
    }
    const argb = pixels[pixel++];
    const slot = cache.find(argb);
    if (slot >= 0) {
      greens.write(bits, GREEN_CODES + slot);
      continue;
    }
    cache.add(argb);
    greens.write(bits, (argb >>> 8) & 255);
    reds.write(bits, (argb >>> 16) & 255);
    blues.write(bits, argb & 255);
    alphas.write(bits, argb >>> 24);
  }
}

/** A way to encode an image, with the frequency of each symbol of the five codes. */
class Plan {
  readonly items: Items;
  readonly cacheBits: number;
  readonly green: Uint32Array;
  readonly red = new Uint32Array(256);
  readonly blue = new Uint32Array(256);
  readonly alpha = new Uint32Array(256);
  readonly distance = new Uint32Array(DISTANCE_CODES);
  /** Estimated bits of the image. */
  readonly cost: number;

  constructor(pixels: Int32Array, items: Items, cacheBits: number) {
    const { lengths, distanceCodes, count } = items;
    this.items = items;
    this.cacheBits = cacheBits;
    this.green = new Uint32Array(GREEN_CODES + (cacheBits > 0 ? 1 << cacheBits : 0));
    const cache = new ColorCache(cacheBits);
    let pixel = 0;
    let extraBits = 0;
    for (let i = 0; i < count; i++) {
      if (distanceCodes[i] > 0) {
        const symbols = [lengthSymbol(lengths[i]), lengthSymbol(distanceCodes[i])];
        this.green[256 + symbols[0]]++;
        this.distance[symbols[1]]++;
        extraBits += extraBitsOf(symbols[0]) + extraBitsOf(symbols[1]);
        for (const end = pixel + lengths[i]; pixel < end; pixel++) cache.add(pixels[pixel]);
        continue;
      }
      const argb = pixels[pixel++];
      const slot = cache.find(argb);
      if (slot >= 0) {
        this.green[GREEN_CODES + slot]++;
        continue;
      }
      cache.add(argb);
      this.green[(argb >>> 8) & 255]++;
      this.red[(argb >>> 16) & 255]++;
      this.blue[argb & 255]++;
      this.alpha[argb >>> 24]++;
    }
    this.cost = [this.green, this.red, this.blue, this.alpha, this.distance].reduce(
      (sum, counts) => sum + entropyOfCounts(counts) + LENGTH_BITS * usedOf(counts),
      extraBits,
    );
  }
}

/** Estimated bits of a code length. */
const LENGTH_BITS = 4;

/** The last pixel of each slot (section 3.6.3). */
class ColorCache {
  readonly #shift: number;
  readonly #colors: Int32Array | null;

  constructor(bits: number) {
    this.#shift = 32 - bits;
    this.#colors = bits > 0 ? new Int32Array(1 << bits) : null;
  }

  /** The slot that holds this pixel, or −1. */
  find(argb: number): number {
    if (!this.#colors) return -1;
    const slot = Math.imul(CACHE_FACTOR, argb) >>> this.#shift;
    return this.#colors[slot] === argb ? slot : -1;
  }

  add(argb: number): void {
    if (this.#colors) this.#colors[Math.imul(CACHE_FACTOR, argb) >>> this.#shift] = argb;
  }
}

/** A Huffman code for symbols of given frequencies; it is written before the symbols. */
class PrefixCode {
  readonly #lengths: Uint8Array;
  readonly #codes: Uint16Array;

  constructor(bits: BitWriter, counts: Uint32Array) {
    const symbols: number[] = [];
    for (let symbol = 0; symbol < counts.length && symbols.length <= 2; symbol++)
      if (counts[symbol] > 0) symbols.push(symbol);
    const [first = 0, second = first] = symbols;
    if (symbols.length <= 2 && second < 256) {
      bits.write(1, 1);
      bits.write(symbols.length === 2 ? 1 : 0, 1);
      bits.write(first < 2 ? 0 : 1, 1);
      bits.write(first, first < 2 ? 1 : 8);
      if (symbols.length === 2) bits.write(second, 8);
      this.#lengths = new Uint8Array(counts.length);
      if (symbols.length === 2) this.#lengths[first] = this.#lengths[second] = 1;
    } else {
      this.#lengths = codeLengths(counts, MAX_CODE_LENGTH);
      bits.write(0, 1);
      writeLengths(bits, this.#lengths);
      // A single symbol takes no bits.
      if (symbols.length === 1) this.#lengths.fill(0);
    }
    this.#codes = codesOf(this.#lengths);
  }

  write(bits: BitWriter, symbol: number): void {
    bits.write(this.#codes[symbol], this.#lengths[symbol]);
  }
}

/** Writes the lengths of a code's symbols (section 3.7.2.1.2). */
function writeLengths(bits: BitWriter, lengths: Uint8Array): void {
  const runs = runsOf(lengths);
  const counts = new Uint32Array(CODE_LENGTH_ORDER.length);
  for (const { symbol } of runs) counts[symbol]++;
  const lengthLengths = codeLengths(counts, MAX_LENGTH_LENGTH);
  let written = CODE_LENGTH_ORDER.length;
  while (written > 4 && lengthLengths[CODE_LENGTH_ORDER[written - 1]] === 0) written--;
  bits.write(written - 4, 4);
  for (let i = 0; i < written; i++) bits.write(lengthLengths[CODE_LENGTH_ORDER[i]], 3);
  // The full alphabet follows.
  bits.write(0, 1);
  if (usedOf(counts) === 1) lengthLengths.fill(0);
  const codes = codesOf(lengthLengths);
  for (const { symbol, extra, extraBits } of runs) {
    bits.write(codes[symbol], lengthLengths[symbol]);
    bits.write(extra, extraBits);
  }
}

interface Run {
  /** A length; or 16, which repeats the previous length; or 17 and 18, which repeat 0. */
  readonly symbol: number;
  readonly extra: number;
  readonly extraBits: number;
}

function runsOf(lengths: Uint8Array): Run[] {
  const runs: Run[] = [];
  let before = 8;
  for (let at = 0; at < lengths.length; ) {
    const length = lengths[at];
    let end = at + 1;
    while (end < lengths.length && lengths[end] === length) end++;
    while (at < end) {
      const left = end - at;
      if (length === 0 && left >= 11) {
        const repeats = Math.min(left, 138);
        runs.push({ symbol: 18, extra: repeats - 11, extraBits: 7 });
        at += repeats;
      } else if (length === 0 && left >= 3) {
        const repeats = Math.min(left, 10);
        runs.push({ symbol: 17, extra: repeats - 3, extraBits: 3 });
        at += repeats;
      } else if (length !== 0 && length === before && left >= 3) {
        const repeats = Math.min(left, 6);
        runs.push({ symbol: 16, extra: repeats - 3, extraBits: 2 });
        at += repeats;
      } else {
        runs.push({ symbol: length, extra: 0, extraBits: 0 });
        if (length !== 0) before = length;
        at++;
      }
    }
  }
  return runs;
}

/** The symbol of a length or a distance code (section 3.6.2.2). */
function lengthSymbol(value: number): number {
  if (value <= 4) return value - 1;
  const bits = 31 - Math.clz32(value - 1);
  return 2 * bits + (((value - 1) >> (bits - 1)) & 1);
}

/** Number of extra bits after this symbol. */
function extraBitsOf(symbol: number): number {
  return symbol < 4 ? 0 : (symbol - 2) >> 1;
}

function writeLength(bits: BitWriter, value: number, firstSymbol: number, code: PrefixCode): void {
  const symbol = lengthSymbol(value);
  code.write(bits, firstSymbol + symbol);
  const extraBits = extraBitsOf(symbol);
  bits.write((value - 1) & ((1 << extraBits) - 1), extraBits);
}

/** Entropy of all pixels in bits, each channel by itself. */
function entropyOf(pixels: Int32Array): number {
  const counts = new Uint32Array(4 * 256);
  for (let i = 0; i < pixels.length; i++) {
    const argb = pixels[i];
    counts[argb & 255]++;
    counts[256 + ((argb >>> 8) & 255)]++;
    counts[512 + ((argb >>> 16) & 255)]++;
    counts[768 + (argb >>> 24)]++;
  }
  let bits = 0;
  for (let channel = 0; channel < 4; channel++)
    bits += entropyOfCounts(counts.subarray(256 * channel, 256 * (channel + 1)));
  return bits;
}

/** Entropy of symbols with these frequencies, in bits. */
function entropyOfCounts(counts: Uint32Array): number {
  let total = 0;
  let bits = 0;
  for (const count of counts) {
    if (count === 0) continue;
    total += count;
    bits -= count * Math.log2(count);
  }
  return total === 0 ? 0 : bits + total * Math.log2(total);
}

function usedOf(counts: Uint32Array): number {
  let used = 0;
  for (const count of counts) if (count > 0) used++;
  return used;
}

/** Writes bits from the lowest of each byte on. */
class BitWriter {
  #bytes = new Uint8Array(1 << 12);
  #length = 0;
  /** Bits of an incomplete byte. */
  #window = 0;
  #windowBits = 0;

  /** @param count number of low bits of `value`, up to 24; all higher bits must be 0. */
  write(value: number, count: number): void {
    this.#window |= value << this.#windowBits;
    this.#windowBits += count;
    if (this.#length + 4 > this.#bytes.length) {
      const larger = new Uint8Array(2 * this.#bytes.length);
      larger.set(this.#bytes);
      this.#bytes = larger;
    }
    while (this.#windowBits >= 8) {
      this.#bytes[this.#length++] = this.#window;
      this.#window >>>= 8;
      this.#windowBits -= 8;
    }
  }

  /** All bytes; the last is padded with zeros. */
  finish(): Uint8Array<ArrayBuffer> {
    const rest = this.#windowBits > 0 ? 1 : 0;
    const bytes = this.#bytes.slice(0, this.#length + rest);
    if (rest > 0) bytes[this.#length] = this.#window;
    return bytes;
  }
}
