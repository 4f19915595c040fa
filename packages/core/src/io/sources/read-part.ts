import { SplatFileError } from '../../errors.ts';
import type { SplatFormatOptions, SplatInput } from '../formats/splat-format.ts';
import { ByteReader } from './byte-reader.ts';
import { readAll } from './read-all.ts';
import { limitsOf } from './read-limits.ts';

/**
 * Reads another file of the scene of `input`.
 *
 * Rejects with SplatFileError 'missing-part' where the source is a single file, or has no such part; as `openSource`; and with the
 * signal's reason.
 *
 * @param path from the folder of `input`.
 */
export async function readPart(
  { name, openPart }: SplatInput,
  path: string,
  { signal, maxBytes }: Pick<SplatFormatOptions, 'signal' | 'maxBytes'>,
): Promise<Uint8Array<ArrayBuffer>> {
  if (!openPart) {
    const advice = 'Open all files of the scene together, or its address';
    throw new SplatFileError('missing-part', name, `it needs ${path}, another file. ${advice}.`);
  }
  const opened = await openPart(path);
  const reader = new ByteReader(opened, signal, limitsOf({ maxBytes }, opened).maxBytes);
  try {
    return await readAll(reader, Number.POSITIVE_INFINITY, opened.isHeld ? opened.totalBytes : 0);
  } finally {
    reader.close();
  }
}
