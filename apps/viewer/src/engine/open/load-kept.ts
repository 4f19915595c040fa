import { type SplatCloud, type SplatEngine, WebSplatterError } from '@websplatter/core';
import { keepBricks, keptBricks, samplePly } from '@websplatter/core/keep';
import type { LoadState } from '../../state/scene.ts';

export interface LoadKeptOptions {
  readonly signal: AbortSignal;
  readonly onProgress: (progress: Omit<LoadState, 'title'>) => void;
  /** Called with a sample of the splats, unless the file has been converted before. */
  readonly onSample: (sample: SplatCloud) => void;
}

/** A streamed cloud, or a sample of the file's splats with the error that prevented streaming. */
export interface KeptCloud {
  readonly cloud: SplatCloud;
  readonly failure?: Error;
}

/** Error codes for files that cannot be streamed, and for browsers without storage. */
const WHOLE = ['unknown-format', 'storage-unavailable'];

/** Controllers that end the use of stored scenes, by cloud. */
const uses = new Map<SplatCloud, AbortController>();

/** Releases stored scenes whose clouds are destroyed, so that their files can be removed. */
export function endUses(): void {
  for (const [cloud, use] of uses) {
    if (!cloud.isDestroyed) continue;
    use.abort();
    uses.delete(cloud);
  }
}

/**
 * Streams a file from the browser's storage. A sample is shown while the file is converted for
 * streaming, and if the conversion fails. Null if the file cannot be streamed.
 */
export async function loadKept(
  engine: SplatEngine,
  file: File,
  { signal, onProgress, onSample }: LoadKeptOptions,
): Promise<KeptCloud | null> {
  endUses();
  const use = new AbortController();
  const endUse = () => use.abort(signal.reason);
  signal.addEventListener('abort', endUse, { once: true });
  const { name, size } = file;
  let sample: SplatCloud | null = null;
  try {
    let bricks = await keptBricks(file, { signal: use.signal });
    if (!bricks) {
      sample = await engine.load(await samplePly(file, { signal }), { name, fit: 'auto', signal });
      onSample(sample);
      bricks = await keepBricks(file, {
        signal: use.signal,
        onProgress: (fraction) =>
          onProgress({
            phase: 'keep',
            loadedBytes: Math.round(fraction * size),
            totalBytes: size,
            splats: 0,
            bytesPerSecond: 0,
          }),
      });
    }
    const cloud = await engine.load(bricks, { name, signal });
    uses.set(cloud, use);
    destroyLater(sample);
    return { cloud };
  } catch (error) {
    use.abort();
    if (sample && !signal.aborted) return { cloud: sample, failure: error as Error };
    destroyLater(sample);
    if (error instanceof WebSplatterError && WHOLE.includes(error.code)) return null;
    throw error;
  } finally {
    signal.removeEventListener('abort', endUse);
  }
}

/** Destroys a cloud once another scene has replaced it. */
function destroyLater(cloud: SplatCloud | null): void {
  setTimeout(() => cloud?.destroy());
}
