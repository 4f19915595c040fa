import {
  type CloudPrecision,
  type LastingSource,
  type SourceOptions,
  type SplatCloud,
  type SplatEngine,
  SplatSourceError,
} from '@websplatter/core';
import { type Box3, Vector3 } from 'three/webgpu';
import type { DataEdits } from './data-edits.ts';

/** Facts about splats since their first load. */
interface KnownSplats {
  readonly name: string;
  readonly count: number;
  readonly bounds: Box3;
  readonly isPreview: boolean;
  readonly edits: DataEdits | null;
}

/**
 * Loads splats from `source` once more. A preview is not loaded again: its promise stays pending
 * until the signal aborts, because the whole splats will replace it.
 *
 * @throws SplatSourceError if the source is gone, or has other splats now.
 */
export async function readAgain(
  { name, count, bounds: known, isPreview, edits }: KnownSplats,
  source: LastingSource | null,
  engine: SplatEngine,
  options: SourceOptions & { readonly precision: CloudPrecision; readonly signal: AbortSignal },
): Promise<SplatCloud> {
  if (isPreview) return aborted(options.signal);
  if (source === null) {
    const gone =
      'its splats have left the only GPU that held them, and were given without a source to read again.';
    throw new SplatSourceError(name, gone);
  }
  const cloud = await engine.load(source, { ...options, name });
  const { min, max } = cloud.bounds;
  const bounds = edits?.uneditedBounds ?? known;
  const isSame =
    cloud.count === count && bounds.min.equals(new Vector3(...min)) && bounds.max.equals(new Vector3(...max));
  if (isSame) await edits?.follow(cloud);
  if (isSame && !options.signal.aborted) return cloud;
  cloud.destroy();
  options.signal.throwIfAborted();
  const message = `its source has other splats than when it was loaded (${cloud.count}, then ${count}). Load it again to see them.`;
  throw new SplatSourceError(name, message);
}

/** Rejects with the signal's reason when it aborts. */
function aborted(signal: AbortSignal): Promise<never> {
  return new Promise((_, reject) => {
    const end = () => reject(signal.reason);
    if (signal.aborted) end();
    else signal.addEventListener('abort', end);
  });
}
