import { CHUNK_WORDS } from '../layout/chunk-words.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { PackedCloud } from '../packing/packed-cloud.ts';
import { BoxTree } from './box-tree.ts';

/** What rays are tested against: a part of a SplatCloud or a PackedCloud. */
export type CloudOutline = Pick<PackedCloud, 'origin' | 'chunks' | 'robustBounds'>;

/** Where a ray meets a cloud's bounds, in scene space. */
export interface CloudHit {
  /** In units of the direction's length. */
  readonly distance: number;
  readonly point: Vec3;
}

/**
 * Returns where a ray in scene space first meets the bounds of a chunk of 256 splats. The result is as coarse as the chunks,
 * but takes only some microseconds for millions of splats, without waiting for the GPU; `pick` finds the splat itself. A ray
 * that begins inside a chunk's bounds meets it at distance 0.
 *
 * Bounds are those of the splats' centres, widened by the chunk's largest standard deviation. In clouds of several chunks,
 * they are widened by at most an eighth of the box's longest side, since one large splat says little about the others.
 * Captures scatter a few splats through wide empty space around the scene: boxes longer than most of the scene (in clouds of
 * thousands of chunks, longer than a quarter of it) are nearly empty and often contain the camera itself, so rays ignore
 * them.
 *
 * @param direction vector of any length.
 * @returns null if the ray misses or is not finite.
 */
export function raycastCloud(cloud: CloudOutline, origin: Vec3, direction: Vec3): CloudHit | null {
  const local = origin.map((value, axis) => value - cloud.origin[axis]);
  const { distance } = chunkTree(cloud).nearestEntry(local, direction);
  if (distance === Number.POSITIVE_INFINITY) return null;
  const along = (axis: number) => origin[axis] + distance * direction[axis];
  return { distance, point: [along(0), along(1), along(2)] };
}

/** Trees by the buffer of the chunks, which a cloud shares with the PackedCloud that it was uploaded from. */
const trees = new WeakMap<ArrayBuffer, BoxTree>();

/** @internal Returns the tree over a cloud's widened chunk bounds, relative to its origin; built on first use. */
export function chunkTree(cloud: CloudOutline): BoxTree {
  let tree = trees.get(cloud.chunks);
  if (!tree) {
    tree = new BoxTree(chunkBoxes(cloud));
    trees.set(cloud.chunks, tree);
  }
  return tree;
}

/** Largest widening of a chunk's box, as a fraction of the box's longest side. */
const MOST_WIDENED = 1 / 8;

/**
 * Longest box that rays can hit, as a fraction of the scene's longest side. n chunks that tile surfaces are about 1/√n of the
 * scene long, and two or three times that where the Morton order turns; with fewer than 64 chunks, boxes may have any
 * length.
 */
function longestBox(chunkCount: number): number {
  return Math.max(1 / 4, 8 / Math.sqrt(chunkCount));
}

function chunkBoxes({ chunks, robustBounds }: CloudOutline): Float64Array {
  const values = new Float32Array(chunks);
  const { minPosition, maxPosition, maxScale, count: stride } = CHUNK_WORDS;
  const chunkCount = values.length / stride;
  const sceneSide = Math.max(...robustBounds.max.map((high, axis) => high - robustBounds.min[axis]));
  const longestSide = sceneSide > 0 ? sceneSide * longestBox(chunkCount) : Number.POSITIVE_INFINITY;
  const boxes = new Float64Array(6 * chunkCount);
  let end = 0;
  for (let at = 0; at < values.length; at += stride) {
    const min = values.subarray(at + minPosition, at + minPosition + 3);
    const max = values.subarray(at + maxPosition, at + maxPosition + 3);
    const side = Math.max(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
    if (side > longestSide) continue;
    const deviation = values[at + maxScale];
    const widening = chunkCount > 1 && side > 0 ? Math.min(deviation, MOST_WIDENED * side) : deviation;
    for (let axis = 0; axis < 3; axis++) {
      boxes[end + axis] = min[axis] - widening;
      boxes[end + 3 + axis] = max[axis] + widening;
    }
    end += 6;
  }
  return boxes.subarray(0, end);
}
