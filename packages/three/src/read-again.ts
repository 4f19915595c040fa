import { type CloudPrecision, type SplatCloud, type SplatEngine, SplatSourceError } from '@websplatter/core';
import { type Box3, Vector3 } from 'three/webgpu';

/** What is known of splats since their first load. */
interface KnownSplats {
  readonly name: string;
  readonly count: number;
  readonly bounds: Box3;
}

/** Loads splats from `source` once more. @throws SplatSourceError if it is gone, or has other splats now. */
export async function readAgain(
  { name, count, bounds }: KnownSplats,
  source: string | Blob | null,
  engine: SplatEngine,
  options: { readonly precision: CloudPrecision; readonly signal: AbortSignal },
): Promise<SplatCloud> {
  if (source === null) {
    const gone =
      'its splats have left the only GPU that held them, and were given without a source to read again.';
    throw new SplatSourceError(name, gone);
  }
  const cloud = await engine.load(source, { ...options, name });
  const { min, max } = cloud.bounds;
  const isSame =
    cloud.count === count && bounds.min.equals(new Vector3(...min)) && bounds.max.equals(new Vector3(...max));
  if (isSame && !options.signal.aborted) return cloud;
  cloud.destroy();
  options.signal.throwIfAborted();
  const message = `its source has other splats than when it was loaded (${cloud.count}, then ${count}). Load it again to see them.`;
  throw new SplatSourceError(name, message);
}
