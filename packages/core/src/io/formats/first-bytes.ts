/** First bytes of files: constants and patterns that readers share with `formats.ts`. */

export const BRICKS_MAGIC = 'WSBRICKS';
export const FRAMES_MAGIC = 'WSFRAMES';
/** Signature of a Spark scene (`.rad`). */
export const RAD_MAGIC = 'RAD0';
/** Signature of each chunk of a Spark scene. */
export const CHUNK_MAGIC = 'RADC';
/** Signature of SPZ; before version 4, of the unpacked contents of gzip. */
export const SPZ_MAGIC = 'NGSP';

/** A `chunk` element with bounds; other PLY files may have an element of this name. */
const COMPRESSED = /\selement chunk \d+(\s+property \w+ \w+)*?\s+property \w+ m(in|ax)_/;
/** A header whose vertices have colours and no harmonics. */
const POINTS = /^(?!.*\sf_dc_0\s).*\sred\s.*\send_header\s/s;

/** As many as fit the stack of any browser. */
const MOST_ARGUMENTS = 4096;

/** Decodes bytes as Latin-1, one character per byte, for regular expressions. */
export function latin1(bytes: Uint8Array): string {
  let text = '';
  for (let start = 0; start < bytes.length; start += MOST_ARGUMENTS) {
    const codes: ArrayLike<number> = bytes.subarray(start, start + MOST_ARGUMENTS);
    // Not a spread, which takes twenty times as long.
    text += String.fromCharCode.apply(null, codes as number[]);
  }
  return text;
}

export function isGzip(firstBytes: Uint8Array): boolean {
  return firstBytes[0] === 0x1f && firstBytes[1] === 0x8b;
}

/** The kind of a PLY; null if the file is no PLY. */
export function plyKindOf(firstBytes: Uint8Array): 'ply' | 'compressed-ply' | 'ply-points' | null {
  const text = latin1(firstBytes);
  if (!/^ply\s/.test(text)) return null;
  if (COMPRESSED.test(text)) return 'compressed-ply';
  return POINTS.test(text) ? 'ply-points' : 'ply';
}
