import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import type { ScenePool } from './scene-pool.ts';
import { type MissingPart, type SceneParts, SceneStream } from './scene-stream.ts';
import { type StreamContext, type StreamNeed, type StreamOptions, withShare } from './stream-budget.ts';

/**
 * Makes a cloud with the pool of a scene, and the stream that fills it. Leaves nothing allocated on
 * failure.
 *
 * @param makePool makes a pool of this many bytes.
 * @param begin places the first parts in the pool, of a share of this many bytes.
 * @throws the signal's reason; errors of `withShare`, `makePool` and `begin`.
 */
export function streamInto<Pool extends ScenePool, Part extends MissingPart>(
  { shares }: StreamContext,
  need: StreamNeed,
  options: StreamOptions & Pick<SplatCloudOptions, 'onDestroyed'>,
  makePool: (bytes: number) => Promise<Pool>,
  begin: (pool: Pool, bytes: number) => SceneParts<Part>,
): Promise<SplatCloud> {
  return withShare(shares, need, options, async (shareBytes, leave) => {
    const pool = await makePool(shareBytes);
    try {
      options.signal?.throwIfAborted();
      const stream = new SceneStream(begin(pool, shareBytes));
      const made = pool.cloud({
        stream,
        onDestroyed: (cloud) => {
          leave();
          options.onDestroyed?.(cloud);
        },
      });
      return { made, resize: (bytes) => stream.resize(bytes) };
    } catch (error) {
      pool.destroy();
      throw error;
    }
  });
}
