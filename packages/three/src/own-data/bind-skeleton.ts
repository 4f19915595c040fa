import { InvalidArgumentError, type PackedCloud, type SplatCloud, SplatSourceError } from '@websplatter/core';
import { flushEdits, followSkin, type SkinWeights, SplatSkin } from '@websplatter/core/own-data';
import { type Box3, Matrix4, type Skeleton, type Vector3 } from 'three/webgpu';
import type { DataEdits } from '../cloud/data-edits.ts';
import { ChangeAnnouncer, takeBounds, tellObjects } from '../cloud/shown-data.ts';
import type { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import type { SplatData } from '../cloud/splat-data.ts';

/** Differences below this are rounding: part of 1, and of the size of the cloud for translations. */
const ROUNDING = 1e-7;
const IDENTITY = /* @__PURE__ */ new Matrix4().elements;

/**
 * Lets the bones of a skeleton move the splats of a cloud, as a SkinnedMesh's move its vertices: by up to
 * four bones for each row of the file. Before each frame, the bones' matrices are read. If any has
 * changed, the cloud's geometry is rewritten on the GPU; else nothing is done. Frames are not requested.
 *
 * All objects with the same data show the pose, which is relative to `object`. Bounds, rays and picks
 * follow it. Splats turn, stretch and shear; colours that depend on the view keep the directions that
 * they were trained in. The cloud is drawn in full detail, and `editsOf` refuses its data.
 *
 * May be called again for the same data, with the same arrays of weights: with another skeleton, or
 * after the bones or the object have been placed anew.
 *
 * @param weights four bones, as indices into `skeleton.bones`, and four weights for each row.
 * @param bindMatrix cloud to world when `skeleton.boneInverses` were taken, as for `SkinnedMesh.bind`.
 *   Default: the identity, for skeletons that are made in the cloud's own space, as those of files are;
 *   `object.matrixWorld` for one that is made around a cloud in its place.
 * @throws InvalidArgumentError for an object without data, for data with edits, a morph or other weights,
 *   for more than 256 bones, and for weights that `SplatSkin` refuses, such as a row without weights;
 *   SplatSourceError for a preview. A file with more rows than weights goes to the objects' `onError`.
 * @example
 * const set = await readSplats('/robot.ply');
 * const cloud = new SplatCloudObject(makeSplatData(set));
 * bones[0].updateMatrixWorld(true); // the root bone, where the splats are in their file
 * const skeleton = new Skeleton(bones);
 * bindSkeleton(cloud, skeleton, weightsFromBones(set, bones));
 * scene.add(cloud, bones[0]);
 * bones[1].rotation.z = 0.5; // in the next frame
 */
export function bindSkeleton(
  object: SplatCloudObject,
  skeleton: Skeleton,
  weights: SkinWeights,
  bindMatrix: Matrix4 = new Matrix4(),
): void {
  const { data } = object;
  if (!data) throw new InvalidArgumentError('object', 'The object has no data; set its `data` first.');
  if (!Array.isArray(skeleton?.bones))
    throw new InvalidArgumentError(
      'skeleton',
      'The skeleton has no list of bones; pass one of three’s, such as new Skeleton(bones).',
    );
  if (data.isPreview) throw new SplatSourceError(data.name, 'it is still loading: bind it once it is whole.');
  if (data.edits && !(data.edits instanceof SkinnedData))
    throw new InvalidArgumentError('object', `${data.name} ${data.edits.what}, so no skeleton can move it.`);
  object.updateWorldMatrix(true, false);
  const bound = { object, skeleton, bindMatrix: bindMatrix.clone() };
  if (data.edits) data.edits.bind(weights, bound);
  else data.edits = new SkinnedData(data, weights, bound);
}

interface Bound {
  readonly object: SplatCloudObject;
  readonly skeleton: Skeleton;
  readonly bindMatrix: Matrix4;
}

class SkinnedData implements DataEdits {
  readonly what = 'has a skeleton';
  readonly uneditedBounds: Box3;
  readonly #data: SplatData;
  readonly #skin: SplatSkin;
  readonly #weights: SkinWeights;
  readonly #announcer: ChangeAnnouncer;
  #bound: Bound;

  constructor(data: SplatData, weights: SkinWeights, bound: Bound) {
    this.#data = data;
    this.#weights = weights;
    this.#bound = bound;
    this.#skin = new SplatSkin(weights, bound.skeleton.bones.length);
    this.#skin.beforeFrame = () => this.#pose();
    this.uneditedBounds = data.bounds.clone();
    // The frame that reads the bones shows them.
    this.#announcer = new ChangeAnnouncer(
      data,
      (clouds) => {
        for (const cloud of clouds) takeBounds(data, cloud);
      },
      false,
    );
    this.#pose();
    for (const { cloud } of data.places)
      void Promise.resolve(cloud).then(
        (there) => this.follow(there),
        // Callers of `acquire` receive the error of a load.
        () => {},
      );
  }

  get version(): number {
    return this.#skin.version;
  }

  /** @throws InvalidArgumentError for other weights, or another number of bones. */
  bind({ indices, weights }: SkinWeights, bound: Bound): void {
    const { name } = this.#data;
    if (indices !== this.#weights.indices || weights !== this.#weights.weights) {
      const message = `${name} has other weights already; pass the same arrays, or make new data.`;
      throw new InvalidArgumentError('weights', message);
    }
    const { length } = bound.skeleton.bones;
    if (length !== this.#skin.jointCount) {
      const message = `The skeleton has ${length} bones; ${name} is bound to ${this.#skin.jointCount}.`;
      throw new InvalidArgumentError('skeleton', message);
    }
    this.#bound = bound;
    bound.object.requestFrame();
  }

  /** @param _packed the skin needs the cloud's planes. */
  async follow(cloud: SplatCloud, _packed?: PackedCloud): Promise<void> {
    try {
      await followSkin(cloud, this.#skin);
      this.#bound.object.requestFrame();
    } catch (error) {
      tellObjects(this.#data, error);
    }
  }

  flush(cloud: SplatCloud): void {
    flushEdits(cloud);
  }

  move(row: number, center: Vector3): void {
    if (row < this.#skin.rowCount) center.set(...this.#skin.moved(row, [center.x, center.y, center.z]));
  }

  /** Reads the bones, which three has placed for the frame. */
  #pose(): void {
    const { object, skeleton, bindMatrix } = this.#bound;
    const { min, max } = this.uneditedBounds;
    const size = Math.max(1e-30, min.length(), max.length());
    const toCloud = object.matrixWorld.clone().invert();
    const matrix = new Matrix4();
    const pose: number[] = [];
    for (const [joint, bone] of skeleton.bones.entries()) {
      matrix
        .multiplyMatrices(toCloud, bone.matrixWorld)
        .multiply(skeleton.boneInverses[joint])
        .multiply(bindMatrix);
      pose.push(...matrix.elements);
    }
    const isNear = (other: ArrayLike<number>) =>
      pose.every(
        (value, at) => Math.abs(value - other[at % other.length]) <= ROUNDING * (at % 16 >= 12 ? size : 1),
      );
    // Exact, so that splats at rest are as they were loaded.
    const snapped = isNear(IDENTITY) ? pose.map((_, at) => IDENTITY[at % 16]) : pose;
    if (snapped === pose && isNear(this.#skin.pose)) return;
    if (this.#skin.setPose(snapped)) this.#announcer.announce();
  }
}
