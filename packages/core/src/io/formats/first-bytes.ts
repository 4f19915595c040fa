/** First bytes of files: constants and patterns that readers share with `formats.ts`. */

export const BRICKS_MAGIC = 'WSBRICKS';
/** First bytes of a scene by Spark. */
export const RAD_MAGIC = 'RAD0';
/** First bytes of each chunk of a scene by Spark. */
export const CHUNK_MAGIC = 'RADC';
/** First bytes of SPZ; before version 4, of the contents that gzip has packed. */
export const SPZ_MAGIC = 'NGSP';

/** A chunk with bounds. Any PLY may have an element of that name. */
const COMPRESSED = /\selement chunk \d+(\s+property \w+ \w+)*?\s+property \w+ m(in|ax)_/;
/** A header in which vertices have colours of their own instead of harmonics. */
const POINTS = /^(?!.*\sf_dc_0\s).*\sred\s.*\send_header\s/s;

/** Bytes as text, one character each, for patterns. */
export function latin1(bytes: Uint8Array): string {
  return Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
}

export function isGzip(firstBytes: Uint8Array): boolean {
  return firstBytes[0] === 0x1f && firstBytes[1] === 0x8b;
}

/** The format of a PLY; null for files that are no PLY. */
export function plyKindOf(firstBytes: Uint8Array): 'ply' | 'compressed-ply' | 'ply-points' | null {
  const text = latin1(firstBytes);
  if (!/^ply\s/.test(text)) return null;
  if (COMPRESSED.test(text)) return 'compressed-ply';
  return POINTS.test(text) ? 'ply-points' : 'ply';
}
