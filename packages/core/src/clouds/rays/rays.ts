import { fetched } from '../../data/errors.ts';
import { given, SPLATS } from '../../data/given.ts';
import type { PackedCloud } from '../../data/packing/packed-cloud.ts';
import type { SplatCloud } from '../splat-cloud.ts';
import type { MakeRayTreeOptions } from './make-ray-tree.ts';
import type { RayTree } from './ray-tree.ts';

/**
 * Makes a tree to cast rays at, in a worker, or on this thread in tasks of about 5 ms if none can
 * start. Takes a quarter of a second for half a million splats on a server's core. The geometry of
 * a cloud on the GPU is read back, in pieces of at most 2 MiB. A moving cloud is met as it is at one
 * time.
 *
 * @throws InvalidArgumentError for a `time` that is not finite; SplatSourceError for a preview;
 *   DestroyedError if cloud, engine or device end first; GpuLimitError if the device lacks memory;
 *   WebSplatterError `worker-failed` if the worker dies; the signal's reason.
 * @example
 * const tree = await makeRayTree(cloud);
 * const hit = tree.cast([0, 1, 0], [0, -1, 0]);
 * const distance = hit?.distance;
 */
export async function makeRayTree(
  splats: SplatCloud | PackedCloud,
  options: MakeRayTreeOptions = {},
): Promise<RayTree> {
  given(options);
  given(splats, SPLATS, 'splats');
  // Fetched on demand, because most pages cast no rays.
  const trees = await fetched('rays', import('./make-ray-tree.ts'));
  return trees.makeRayTree(splats, options);
}
