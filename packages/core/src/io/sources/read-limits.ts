import { SplatFileError } from '../../data/errors.ts';
import type { OpenedSource, ReadLimits } from './splat-source.ts';

/** As many splats of degree 3, 248 bytes each as trained, as fit into `DEFAULT_MAX_BYTES`. */
const DEFAULT_MAX_SPLATS = 2 ** 25;
const DEFAULT_MAX_BYTES = 2 ** 33;
/** Largest accepted compression ratio. Zeros reach a thousand; floats of a scene stay far below. */
const MOST_UNPACKED = 64;
/** This many unpacked bytes are always accepted. */
const HARMLESS_BYTES = 2 ** 26;

/** Returns the limits for reading `opened`. */
export function limitsOf(
  { maxBytes, maxSplats = DEFAULT_MAX_SPLATS }: ReadLimits,
  { isLocal, sentBytes }: Pick<OpenedSource, 'isLocal' | 'sentBytes'>,
): Required<ReadLimits> {
  const fromServer = Math.max(HARMLESS_BYTES, MOST_UNPACKED * (sentBytes ?? Number.POSITIVE_INFINITY));
  const usual = isLocal ? Number.POSITIVE_INFINITY : Math.min(DEFAULT_MAX_BYTES, fromServer);
  return { maxBytes: maxBytes ?? usual, maxSplats };
}

/** Most bytes that a compressed source may unpack to. */
export function unpackedLimit(
  { maxBytes }: ReadLimits,
  { totalBytes = Number.POSITIVE_INFINITY }: Pick<OpenedSource, 'totalBytes'>,
): number {
  return maxBytes ?? Math.min(DEFAULT_MAX_BYTES, Math.max(HARMLESS_BYTES, MOST_UNPACKED * totalBytes));
}

/** @throws SplatFileError 'too-large' if the stated size exceeds the limit. */
export function checkSize(
  { name, totalBytes = 0 }: Pick<OpenedSource, 'name' | 'totalBytes'>,
  maxBytes: number,
): void {
  if (totalBytes <= maxBytes) return;
  const message = `it has ${totalBytes} bytes, more than maxBytes, ${maxBytes}. Pass a larger maxBytes if that is right.`;
  throw new SplatFileError('too-large', name, message);
}
