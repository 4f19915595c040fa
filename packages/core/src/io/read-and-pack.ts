import { type PackedCloud, packCloud } from '../packing/packed-cloud.ts';
import type { LoadSettings } from './load-messages.ts';
import { readSource } from './read-source.ts';
import type { LoadProgress, ReadOptions, SplatSource } from './splat-source.ts';

/** Does a whole load in the calling thread. */
export async function readAndPack(
  source: SplatSource,
  { name, shPrecision, geometryPrecision }: LoadSettings,
  { signal, onProgress }: Pick<ReadOptions, 'signal' | 'onProgress'>,
): Promise<PackedCloud> {
  let last: LoadProgress | undefined;
  const set = await readSource(source, {
    name,
    shPrecision,
    signal,
    onProgress: (progress) => {
      last = progress;
      onProgress?.(progress);
    },
  });
  if (last) onProgress?.({ ...last, phase: 'arrange' });
  // Packing does not pause: this is the last chance to stop before it.
  signal?.throwIfAborted();
  return packCloud(set, { geometryPrecision });
}
