import { inflateSync } from 'node:zlib';
import { describe, expect, it } from 'vitest';
import { PngWriter, writePixels } from './png-writer.ts';

/** Chunks of a PNG by type; several of one type are joined. Checksums are left to PNG decoders. */
async function chunksOf(file: Blob): Promise<Record<string, Buffer>> {
  const bytes = Buffer.from(await file.arrayBuffer());
  expect([...bytes.subarray(0, 8)]).toEqual([137, 80, 78, 71, 13, 10, 26, 10]);
  const chunks: Record<string, Buffer> = {};
  for (let at = 8; at < bytes.length; ) {
    const length = bytes.readUInt32BE(at);
    const type = bytes.toString('latin1', at + 4, at + 8);
    chunks[type] = Buffer.concat([chunks[type] ?? Buffer.alloc(0), bytes.subarray(at + 8, at + 8 + length)]);
    at += length + 12;
  }
  return chunks;
}

describe('a PNG written by rows', () => {
  it.each([3, 4] as const)('has the pixels that were written, of %i channels', async (channels) => {
    const [widthPx, heightPx] = [700, 900];
    const pixels = Uint8Array.from({ length: widthPx * heightPx * channels }, (_, i) => (i * i) % 251);
    const writer = new PngWriter(widthPx, heightPx, channels);
    const half = widthPx * channels * 450;
    await writer.writeRows(pixels.subarray(0, half));
    await writer.writeRows(pixels.subarray(half));
    const { IHDR, IDAT, IEND } = await chunksOf(await writer.finish());
    expect([IHDR.readUInt32BE(0), IHDR.readUInt32BE(4), IHDR[8], IHDR[9]]).toEqual([
      widthPx,
      heightPx,
      8,
      channels === 4 ? 6 : 2,
    ]);
    expect(IEND).toHaveLength(0);
    const rows = inflateSync(IDAT);
    const rowBytes = widthPx * channels;
    const read = new Uint8Array(pixels.length);
    for (let y = 0; y < heightPx; y++) {
      const from = y * (rowBytes + 1);
      expect(rows[from]).toBe(1);
      for (let i = 0; i < rowBytes; i++)
        read[y * rowBytes + i] = rows[from + 1 + i] + (i < channels ? 0 : read[y * rowBytes + i - channels]);
    }
    expect(Buffer.from(read).equals(pixels)).toBe(true);
  });

  it('ends each chunk with its checksum', async () => {
    const bytes = Buffer.from(await (await new PngWriter(1, 1, 3).finish()).arrayBuffer());
    // That of an empty IEND, as every PNG ends.
    expect(bytes.subarray(-4).toString('hex')).toBe('ae426082');
  });

  it('puts pixels on a background, or divides them by their opacity', () => {
    const half = Float32Array.of(0.25, 0.5, 0, 0.5, 0, 0, 0, 0);
    const opaque = new Uint8Array(6);
    writePixels(half, opaque, [1, 0, 0]);
    expect([...opaque]).toEqual([191, 128, 0, 255, 0, 0]);
    const transparent = new Uint8Array(8);
    writePixels(half, transparent, null);
    expect([...transparent]).toEqual([128, 255, 0, 128, 0, 0, 0, 0]);
  });
});
