import type { Vec3 } from '../state/vec3.ts';

const SIGNATURE = Uint8Array.of(137, 80, 78, 71, 13, 10, 26, 10);

/** Each byte is the difference from the pixel on the left, which packs smooth pictures better. */
const FILTER_SUB = 1;
const COLOR_TYPES = { 3: 2, 4: 6 } as const;

/** Pixels whose bytes go to the compressor at a time: the page has turns in between. */
const PIXELS_PER_PIECE = 2 ** 18;

/** Writes a PNG of 8 bits per channel by rows: no picture is ever in memory as a whole. */
export class PngWriter {
  readonly #widthPx: number;
  readonly #channels: 3 | 4;
  readonly #compressor = new CompressionStream('deflate');
  readonly #input = this.#compressor.writable.getWriter();
  readonly #packed: Promise<readonly Uint8Array<ArrayBuffer>[]>;
  readonly #header: Uint8Array<ArrayBuffer>;

  /** @param channels red, green and blue, and with 4 of them opacity (not premultiplied). */
  constructor(widthPx: number, heightPx: number, channels: 3 | 4) {
    this.#widthPx = widthPx;
    this.#channels = channels;
    const header = new DataView(new ArrayBuffer(13));
    header.setUint32(0, widthPx);
    header.setUint32(4, heightPx);
    header.setUint8(8, 8);
    header.setUint8(9, COLOR_TYPES[channels]);
    this.#header = chunk('IHDR', new Uint8Array(header.buffer));
    this.#packed = chunksOf(this.#compressor.readable);
  }

  /** Appends whole rows, `channels` bytes per pixel. */
  async writeRows(bytes: Uint8Array): Promise<void> {
    const rowBytes = this.#widthPx * this.#channels;
    const rowsPerPiece = Math.max(1, Math.floor(PIXELS_PER_PIECE / this.#widthPx));
    for (let from = 0; from < bytes.length; from += rowsPerPiece * rowBytes) {
      const piece = bytes.subarray(from, from + rowsPerPiece * rowBytes);
      await this.#input.ready;
      // An error of the input also rejects the read of the compressed bytes, and is reported there.
      this.#input.write(filtered(piece, rowBytes, this.#channels)).catch(() => {});
    }
  }

  /** The file, once all rows have been written. */
  async finish(): Promise<Blob> {
    // `#packed` rejects with the same error.
    this.#input.close().catch(() => {});
    const packed = await this.#packed;
    const parts = [SIGNATURE, this.#header, ...packed, chunk('IEND', new Uint8Array(0))];
    return new Blob(parts, { type: 'image/png' });
  }

  /** Lets go of the written bytes. */
  abort(): void {
    // Who aborts no longer awaits the file.
    this.#packed.catch(() => {});
    this.#input.abort().catch(() => {});
  }
}

/**
 * Converts a row of a view's pixels (premultiplied, 0…1, in the space of the screen) to bytes.
 *
 * @param background the picture's background, 0…1; null leaves it transparent, and `to` has four
 * channels then.
 */
export function writePixels(from: Float32Array, to: Uint8Array, background: Vec3 | null): void {
  let at = 0;
  for (let i = 0; i < from.length; i += 4) {
    const opacity = Math.min(1, Math.max(0, from[i + 3]));
    for (let channel = 0; channel < 3; channel++) {
      const value = background
        ? from[i + channel] + (1 - opacity) * background[channel]
        : from[i + channel] / Math.max(opacity, 1e-9);
      to[at++] = Math.round(255 * Math.min(1, Math.max(0, value)));
    }
    if (!background) to[at++] = Math.round(255 * opacity);
  }
}

function filtered(rows: Uint8Array, rowBytes: number, channels: number): Uint8Array<ArrayBuffer> {
  const rowCount = rows.length / rowBytes;
  const out = new Uint8Array(rows.length + rowCount);
  for (let row = 0; row < rowCount; row++) {
    const from = row * rowBytes;
    const to = from + row;
    out[to] = FILTER_SUB;
    for (let i = 0; i < rowBytes; i++)
      out[to + 1 + i] = rows[from + i] - (i < channels ? 0 : rows[from + i - channels]);
  }
  return out;
}

async function chunksOf(packed: ReadableStream<Uint8Array>): Promise<readonly Uint8Array<ArrayBuffer>[]> {
  const chunks: Uint8Array<ArrayBuffer>[] = [];
  const reader = packed.getReader();
  for (let read = await reader.read(); !read.done; read = await reader.read())
    chunks.push(chunk('IDAT', read.value));
  return chunks;
}

/** A piece of the file: its length, type, bytes, and their checksum. */
function chunk(type: string, bytes: Uint8Array): Uint8Array<ArrayBuffer> {
  const out = new Uint8Array(bytes.length + 12);
  const view = new DataView(out.buffer);
  view.setUint32(0, bytes.length);
  for (let i = 0; i < 4; i++) out[4 + i] = type.charCodeAt(i);
  out.set(bytes, 8);
  view.setUint32(bytes.length + 8, crc32(out.subarray(4, bytes.length + 8)));
  return out;
}

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? 0xedb88320 ^ (crc >>> 1) : crc >>> 1;
  return crc;
});

function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = CRC_TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}
