import { given, SPLATS } from '../data/given.ts';
import type { PackedCloud } from '../data/packing/packed-cloud.ts';
import type { MakeRayTreeOptions } from './make-ray-tree.ts';
import type { RayTree } from './ray-tree.ts';
import type { SplatCloud } from './splat-cloud.ts';

/**
 * Makes the tree that rays are tested against, in a worker where one can start, else on this thread
 * in tasks of about 5 ms: a quarter of a second for half a million splats on a server's core. Reads
 * the geometry of a cloud on the GPU back, in pieces of at most 2 MiB.
 *
 * @throws SplatSourceError for a preview, DestroyedError if cloud, engine or device end first,
 *   GpuLimitError if memory is lacking, WebSplatterError `worker-failed` if the worker dies, the
 *   signal's reason.
 */
export async function makeRayTree(
  splats: SplatCloud | PackedCloud,
  options: MakeRayTreeOptions = {},
): Promise<RayTree> {
  given(options);
  given(splats, SPLATS, 'splats');
  // Pages that cast no rays do not load this module.
  const trees = await import('./make-ray-tree.ts');
  return trees.makeRayTree(splats, options);
}
