import { CHUNK_WORDS } from '../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import type { PackedCloud } from '../data/packing/packed-cloud.ts';
import { checkPacked } from '../data/packing/packed-cloud.ts';
import { buildOfGeometry } from './build-of-geometry.ts';
import { RayTree } from './ray-tree.ts';
import { RayTreeBuilder } from './ray-tree-builder.ts';
import type { SplatCloud } from './splat-cloud.ts';

/** Up to so many splats have a blob each: rays hit the drawn splats. They take 12 MB then. */
const MOST_SMALL_BLOBS = 1 << 19;
/** Splats of a blob in clouds for which that is not enough. */
const SPLATS_PER_BLOB = 32;

/** Options of `makeRayTree`. */
export interface MakeRayTreeOptions {
  /** Calls the work off. */
  readonly signal?: AbortSignal;
  /** @internal For tests: most blobs of a small cloud. */
  readonly mostBlobs?: number;
}

/** See `makeRayTree` of the index. */
export async function makeRayTree(
  splats: SplatCloud | PackedCloud,
  options: MakeRayTreeOptions,
): Promise<RayTree> {
  const { signal, mostBlobs = MOST_SMALL_BLOBS } = options;
  // The last frame may lack edits.
  if ('editing' in splats) splats.editing?.flush();
  else checkPacked(splats);
  const { count, origin } = splats;
  const shares = blobsOfChunks(splats, Math.max(mostBlobs, count / SPLATS_PER_BLOB));
  const blobs = await buildOfGeometry(splats, {
    what: 'rays',
    subject: 'A ray tree',
    plan: { shares },
    // In one piece, since this is the form that bundlers recognise.
    makeWorker: () => new Worker(new URL('./ray-worker.ts', import.meta.url), { type: 'module' }),
    make: (plan) => new RayTreeBuilder(plan, signal),
    signal,
  });
  return new RayTree(origin, blobs);
}

/**
 * How much the angle matters. At 0, all chunks would have as many blobs; at 2, all blobs would be
 * seen under one angle.
 */
const ANGLE_EXPONENT = 2 / 3;

/**
 * Shares blobs out to chunks by the angle under which each is seen from within the scene. Distant
 * regions have few splats, which all matter; near ones have many for each pixel.
 */
function blobsOfChunks(
  { chunks, robustBounds: { min, max }, origin }: Pick<PackedCloud, 'chunks' | 'robustBounds' | 'origin'>,
  blobs: number,
): Uint16Array {
  const values = new Float32Array(chunks);
  const { minPosition, maxPosition, count: stride } = CHUNK_WORDS;
  const nearest = Math.max(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / 2;
  const angles = new Float64Array(values.length / stride);
  for (let chunk = 0; chunk < angles.length; chunk++) {
    let extent2 = 0;
    let distance2 = 0;
    for (let axis = 0; axis < 3; axis++) {
      const low = values[stride * chunk + minPosition + axis];
      const high = values[stride * chunk + maxPosition + axis];
      extent2 += (high - low) ** 2;
      distance2 += (origin[axis] + (low + high) / 2 - (min[axis] + max[axis]) / 2) ** 2;
    }
    const distance = Math.max(Math.sqrt(distance2), nearest, 1e-30);
    angles[chunk] = Math.max((Math.sqrt(extent2) / distance) ** ANGLE_EXPONENT, 1e-12);
  }
  // The factor that shares out all blobs: a chunk takes no more than it has splats.
  const shareAt = (angle: number, factor: number) => Math.max(1, Math.min(CHUNK_SPLATS, angle * factor));
  let low = 1e-3;
  let high = 1e15;
  for (let i = 0; i < 30; i++) {
    const factor = Math.sqrt(low * high);
    let sum = 0;
    for (const angle of angles) sum += shareAt(angle, factor);
    if (sum > blobs) high = factor;
    else low = factor;
  }
  return Uint16Array.from(angles, (angle) => shareAt(angle, low));
}
