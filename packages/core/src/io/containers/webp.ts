import { type FileFinding, SplatFileError, type SplatFileErrorCode } from '../../data/errors.ts';
import { latin1 } from '../formats/first-bytes.ts';
import { decodeVp8l, type ImageSize, Vp8lError, vp8lSize } from './vp8l.ts';

/** A lossless WebP image that has not been decoded. */
export interface WebpImage extends ImageSize {
  readonly file: string;
  /** The coded image, as a view of the file. */
  readonly data: Uint8Array;
}

const RIFF_HEADER_BYTES = 12;
const CHUNK_HEADER_BYTES = 8;
/** Flag in an extended file. */
const ANIMATED = 2;

const EXPORT_AGAIN = 'Download or export it again';
const NEED_LOSSLESS = 'values are exact only in lossless WebP images; export the scene again';

/**
 * Finds the image in a WebP file (RFC 9649), without decoding it.
 *
 * @throws SplatFileError 'unknown-format' (no lossless WebP image), 'truncated', 'damaged'
 */
export function openWebp(bytes: Uint8Array, file: string): WebpImage {
  const fail = (code: SplatFileErrorCode, problem: string | FileFinding, byte: number): never => {
    throw new SplatFileError(code, file, problem, { byte });
  };
  const riff = latin1(bytes.subarray(0, RIFF_HEADER_BYTES));
  if (!/^RIFF....WEBP$/s.test(riff)) return fail('unknown-format', ['is no WebP image', NEED_LOSSLESS], 0);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const end = CHUNK_HEADER_BYTES + view.getUint32(4, true);
  if (end > bytes.length)
    fail(
      'truncated',
      `it says that it has ${end} bytes, and has ${bytes.length}. ${EXPORT_AGAIN}.`,
      bytes.length,
    );
  let canvas: ImageSize | null = null;
  for (let at = RIFF_HEADER_BYTES; at + CHUNK_HEADER_BYTES <= end; ) {
    const kind = latin1(bytes.subarray(at, at + 4));
    const size = view.getUint32(at + 4, true);
    const start = at + CHUNK_HEADER_BYTES;
    if (start + size > end) fail('damaged', `its part ${kind} does not fit into it. ${EXPORT_AGAIN}.`, at);
    const data = bytes.subarray(start, start + size);
    if (kind === 'VP8L') {
      const image = { file, data, ...checked(file, () => vp8lSize(data)) };
      if (canvas && (canvas.width !== image.width || canvas.height !== image.height))
        fail('damaged', `it states a size that its image contradicts. ${EXPORT_AGAIN}.`, at);
      return image;
    }
    if (kind === 'VP8 ') fail('unknown-format', ['is a lossy WebP image', NEED_LOSSLESS], at);
    if (kind === 'VP8X' && size >= 10) {
      if ((data[0] & ANIMATED) !== 0) fail('unknown-format', ['is animated', NEED_LOSSLESS], at);
      const sizeAt = (byte: number) => (view.getUint32(start + byte - 1, true) >>> 8) + 1;
      canvas = { width: sizeAt(4), height: sizeAt(7) };
    }
    at = start + size + (size & 1);
  }
  return fail('damaged', `there is no image in it. ${EXPORT_AGAIN}.`, 0);
}

/**
 * Decodes an image to R, G, B, A of each pixel, row by row from the top left, without loss.
 *
 * @throws SplatFileError 'damaged'
 */
export function decodeWebp({ file, data }: WebpImage): Uint8Array<ArrayBuffer> {
  return checked(file, () => decodeVp8l(data));
}

function checked<Result>(file: string, decode: () => Result): Result {
  try {
    return decode();
  } catch (cause) {
    if (!(cause instanceof Vp8lError)) throw cause;
    throw new SplatFileError(
      'damaged',
      file,
      `it cannot be decoded: ${cause.message}. ${EXPORT_AGAIN}.`,
      {},
      { cause },
    );
  }
}
