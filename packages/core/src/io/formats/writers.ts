import { InvalidArgumentError } from '../../errors.ts';
import type { Harmonics } from '../../packing/harmonics.ts';
import { shown } from '../../printable.ts';
import type { SplatSet } from '../../splats/splat-set.ts';
import type { WriteFormat, WriteOptions } from './write-format.ts';

/** Fetches the code of each of `WRITABLE_FORMATS`, by name. */
const WRITERS: Readonly<Record<string, () => Promise<WriteFormat>>> = {
  ply: async () => (await import('./ply/write-ply.ts')).writePly,
  'compressed-ply': async () => (await import('./compressed-ply/write-compressed-ply.ts')).writeCompressedPly,
  spz: async () => (await import('./spz/write-spz.ts')).writeSpz,
  sog: async () => (await import('./sog/write-sog.ts')).writeSog,
  gltf: async () => (await import('./gltf/write-gltf.ts')).writeGltf,
};

/**
 * Writes splats as a file in the format of this name, one of `WRITABLE_FORMATS`, whose code is fetched first. Works in the calling
 * thread and gives its event loop turns.
 *
 * Rejects with `InvalidArgumentError` if there is no such format ('formatName'), or if it cannot hold these splats ('set'); or with the
 * signal's reason.
 */
export async function writeSplats(
  set: SplatSet<Harmonics>,
  formatName: string,
  options: WriteOptions = {},
): Promise<Uint8Array<ArrayBuffer>> {
  if (!Object.hasOwn(WRITERS, formatName)) {
    const names = Object.keys(WRITERS).join(', ');
    const message = `${shown(formatName)} cannot be written; the format must be one of ${names}.`;
    throw new InvalidArgumentError('formatName', message);
  }
  if (set.count === 0) throw new InvalidArgumentError('set', 'There are no splats to write.');
  const write = await WRITERS[formatName]();
  return write(set, options);
}
