import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import type { PackedCloud } from '../../data/packing/packed-cloud.ts';
import { checkPacked } from '../../data/packing/packed-cloud.ts';
import { buildOfGeometry, checkTime } from '../build-of-geometry.ts';
import { flushFeatures } from '../cloud-feature.ts';
import type { SplatCloud } from '../splat-cloud.ts';
import { RayTree } from './ray-tree.ts';
import { RayTreeBuilder } from './ray-tree-builder.ts';

/**
 * Up to this many splats, each splat has its own blob, so rays hit the drawn splats. The tree then
 * takes at most 12 MB.
 */
const MOST_SMALL_BLOBS = 1 << 19;
/** Splats per blob in larger clouds. */
const SPLATS_PER_BLOB = 32;

/** Options of `makeRayTree`. */
export interface MakeRayTreeOptions {
  /** When rays meet the splats of a moving cloud, in the unit of its file; default its first time. */
  readonly time?: number;
  /** Aborts the work. */
  readonly signal?: AbortSignal;
  /** @internal For tests: most blobs of a small cloud. */
  readonly mostBlobs?: number;
}

/** See `makeRayTree` of the index. */
export async function makeRayTree(
  splats: SplatCloud | PackedCloud,
  options: MakeRayTreeOptions,
): Promise<RayTree> {
  const { time, signal, mostBlobs = MOST_SMALL_BLOBS } = options;
  checkTime(time);
  // Edits since the last frame may not be uploaded yet.
  if ('features' in splats) flushFeatures(splats);
  else checkPacked(splats);
  const { count, origin } = splats;
  const shares = blobsOfChunks(splats, Math.max(mostBlobs, count / SPLATS_PER_BLOB));
  const blobs = await buildOfGeometry(splats, {
    what: 'rays',
    subject: 'A ray tree',
    plan: { shares },
    // Bundlers recognise a worker only in this form, written as one expression.
    makeWorker: () => new Worker(new URL('./ray-worker.ts', import.meta.url), { type: 'module' }),
    make: (plan) => new RayTreeBuilder(plan, signal),
    time,
    signal,
  });
  return new RayTree(origin, blobs);
}

/**
 * Exponent of a chunk's angle in its share of blobs. At 0, all chunks would get equally many; at 2,
 * all blobs would span about the same angle.
 */
const ANGLE_EXPONENT = 2 / 3;

/**
 * Distributes blobs among chunks by the angle under which each chunk appears from within the scene.
 * Distant regions have few splats, all of which matter; near regions have many splats per pixel.
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
  // Bisects for the factor that uses up all blobs; a chunk gets no more blobs than it has splats.
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
