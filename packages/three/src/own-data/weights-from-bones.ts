import { InvalidArgumentError } from '@websplatter/core';
import type { SkinWeights } from '@websplatter/core/own-data';
import { type Bone, Line3, Matrix4, type Object3D, Vector3 } from 'three/webgpu';
import { type SplatDataInput, setOf } from './make-splat-data.ts';

/** Options of `weightsFromBones`. */
export interface BoneWeightsOptions {
  /**
   * How fast a bone's influence falls: weights are in proportion to 1 / distance to this power. More
   * than 0. Low values bend softly, high ones sharply. Default 4.
   */
  readonly falloff?: number;
  /** Object whose local space the splats are in. Default: the splats are in world space. */
  readonly object?: Object3D;
}

/** Bones of a row. */
const MOST_BONES = 4;
/** Part of the bones' extent that counts as no distance. */
const NEAREST = 1e-4;

/**
 * Makes weights for `bindSkeleton` from distances: each row gets the four nearest bones. A bone reaches
 * from its own place to those of its children among `bones`; one without children is a point. A few
 * splats between two limbs may follow the wrong one, as they do in modelling programs: weights may be
 * changed before they are bound.
 *
 * Runs on the calling thread, in time proportional to splats times bones.
 *
 * @param splats as `makeSplatData` takes them; of a file, what `readSplats` returns.
 * @param bones as in `skeleton.bones`, with current world matrices, in the pose that the splats are in.
 * @returns four indices and four weights per row; rows that `splats` lacks follow the first bone.
 * @throws InvalidArgumentError without bones, and for a falloff that is not a number above 0.
 * @example
 * const weights = weightsFromBones(set, bones, { falloff: 6 });
 * bindSkeleton(cloud, new Skeleton(bones), weights);
 */
export function weightsFromBones(
  splats: SplatDataInput,
  bones: readonly Bone[],
  { falloff = 4, object }: BoneWeightsOptions = {},
): SkinWeights & { readonly indices: Uint16Array; readonly weights: Float32Array } {
  if (!Array.isArray(bones) || bones.length === 0)
    throw new InvalidArgumentError('bones', 'There are no bones; pass skeleton.bones, with one at least.');
  if (!(Number.isFinite(falloff) && falloff > 0))
    throw new InvalidArgumentError('falloff', `falloff is ${falloff}; it must be a finite number above 0.`);
  const { positions, fileIndices, origin } = setOf(splats);
  const lines = linesOf(bones, object);
  const [{ line: first }] = lines;
  const extent = lines.reduce((most, { line }) => Math.max(most, line.start.distanceTo(first.start)), 1e-30);
  const rows = fileIndices.reduce((most, row) => Math.max(most, row + 1), 0);
  const indices = new Uint16Array(MOST_BONES * rows);
  const weights = Float32Array.from(indices, (_, k) => (k % MOST_BONES === 0 ? 1 : 0));
  const [center, nearest] = [new Vector3(), new Vector3()];
  const distances = new Float64Array(bones.length);
  for (const [i, row] of fileIndices.entries()) {
    center.fromArray(positions, 3 * i).add({ x: origin[0], y: origin[1], z: origin[2] });
    distances.fill(Number.POSITIVE_INFINITY);
    for (const { bone, line } of lines) {
      const distance = line.closestPointToPoint(center, true, nearest).distanceTo(center);
      distances[bone] = Math.min(distances[bone], Math.max(distance, NEAREST * extent));
    }
    const order = Array.from(distances.keys()).sort((a, b) => distances[a] - distances[b]);
    for (const [k, bone] of order.slice(0, MOST_BONES).entries()) {
      indices[MOST_BONES * row + k] = bone;
      weights[MOST_BONES * row + k] = (distances[order[0]] / distances[bone]) ** falloff;
    }
  }
  return { indices, weights };
}

/** Lines from each bone to its children, in the space of the splats. */
function linesOf(bones: readonly Bone[], object?: Object3D): { bone: number; line: Line3 }[] {
  object?.updateWorldMatrix(true, false);
  const toSplats = object ? object.matrixWorld.clone().invert() : new Matrix4();
  const places = bones.map((bone) =>
    new Vector3().setFromMatrixPosition(bone.matrixWorld).applyMatrix4(toSplats),
  );
  return bones.flatMap((parent, bone) => {
    const ends = bones.flatMap((child, i) => (child.parent === parent ? [places[i]] : []));
    return (ends.length > 0 ? ends : [places[bone]]).map((end) => ({
      bone,
      line: new Line3(places[bone], end),
    }));
  });
}
