import { type SplatCloud, type SplatEngine, WebSplatterError } from '@websplatter/core';
import { keepBricks, keptBricks, samplePly } from '@websplatter/core/keep';
import type { LoadState } from '../state/scene.ts';

export interface LoadKeptOptions {
  readonly signal: AbortSignal;
  readonly onProgress: (progress: Omit<LoadState, 'title'>) => void;
  /** Called with some of the splats, unless all are kept. */
  readonly onSample: (sample: SplatCloud) => void;
}

/** A file that streams, or some of its splats, and why it could not be arranged for that. */
export interface KeptCloud {
  readonly cloud: SplatCloud;
  readonly failure?: Error;
}

/** Codes of errors of files that can only be opened as a whole, and of browsers that keep none. */
const WHOLE = ['unknown-format', 'storage-unavailable'];

/** Ends of the use of kept scenes, by their clouds. */
const uses = new Map<SplatCloud, AbortController>();

/** Lets go of kept scenes whose clouds are gone, so that they can be removed. */
export function endUses(): void {
  for (const [cloud, use] of uses) {
    if (!cloud.isDestroyed) continue;
    use.abort();
    uses.delete(cloud);
  }
}

/**
 * Streams a file that is kept, or shows a sample of it while it is arranged for that, and where that
 * fails. Null for what can only be opened as a whole.
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

/** Destroys a cloud once another scene has taken its place. */
function destroyLater(cloud: SplatCloud | null): void {
  setTimeout(() => cloud?.destroy());
}
