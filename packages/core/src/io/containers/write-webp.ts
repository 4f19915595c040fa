import type { Turns } from '../../data/turns.ts';
import { encodeVp8l } from './write-vp8l.ts';

const HEADER_BYTES = 20;

/** Writes a lossless WebP file (RFC 9649); see `encodeVp8l`. */
export async function encodeWebp(
  width: number,
  height: number,
  rgba: Uint8Array,
  turns: Turns,
): Promise<Uint8Array<ArrayBuffer>> {
  const image = await encodeVp8l(width, height, rgba, turns);
  // Chunks begin at even bytes.
  const bytes = new Uint8Array(HEADER_BYTES + image.length + (image.length & 1));
  const view = new DataView(bytes.buffer);
  bytes.set(new TextEncoder().encode('RIFF'), 0);
  view.setUint32(4, bytes.length - 8, true);
  bytes.set(new TextEncoder().encode('WEBPVP8L'), 8);
  view.setUint32(16, image.length, true);
  bytes.set(image, HEADER_BYTES);
  return bytes;
}
