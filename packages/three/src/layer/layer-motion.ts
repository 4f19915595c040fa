import { type Box3, Matrix4, Vector3 } from 'three/webgpu';

/** Most clouds in one view with motions of their own. */
export const MOST_MOTIONS = 8;

/** Least thickness of a cloud's box, in parts of its size. */
const LEAST_THICKNESS = 0.01;

/** Where a cloud is. */
export interface CloudPose {
  readonly modelMatrix: Matrix4;
  /** In the cloud's own space. */
  readonly bounds: Box3;
}

/** The viewpoint of a frame, and the places of its clouds. */
export interface Pose {
  /** From world to clip space, without the jitter of temporal effects. */
  readonly clipMatrix: Matrix4;
  readonly clouds: ReadonlyMap<object, CloudPose>;
}

/**
 * Motion of a frame's content since the frame before. All matrices take normalised device
 * coordinates of the frame.
 */
export interface Motion {
  /** To the frame's own clip space without jitter. */
  readonly toClip: Matrix4;
  /** At least one, largest first: a place belongs to the last box around it, or the nearest. */
  readonly boxes: readonly MovingBox[];
}

/** The bounds of something that moves as a whole. */
export interface MovingBox {
  /** Takes points in the box to −1…1. */
  readonly toBox: Matrix4;
  /** To clip space of the frame before. */
  readonly toPreviousClip: Matrix4;
}

/** Poses of a view by three's frame number: one frame may draw a view several times. */
export class PoseHistory {
  #frame = -1;
  #current: Pose | null = null;
  #previous: Pose | null = null;

  /** Returns the pose of the last frame before `frame`; `pose` itself if there is none. */
  before(frame: number, pose: Pose): Pose {
    if (frame !== this.#frame) this.#previous = this.#current;
    this.#frame = frame;
    this.#current = pose;
    return this.#previous ?? pose;
  }
}

/**
 * Returns how clouds have moved. A pixel has a position but no cloud. If all clouds have moved alike,
 * motion is exact; if not, a position gets the motion of the cloud with the smallest box around it.
 * Beyond `MOST_MOTIONS` clouds, the smallest move with their surroundings.
 *
 * @param ndcToWorld from normalised device coordinates of the frame, as it is drawn, to world
 *   space.
 */
export function motionBetween(previous: Pose, current: Pose, ndcToWorld: Matrix4): Motion {
  const clouds = [...current.clouds].map(([cloud, pose]) => {
    const before = previous.clouds.get(cloud)?.modelMatrix ?? pose.modelMatrix;
    return { box: boxMatrix(pose), toPrevious: moved(pose.modelMatrix, before) };
  });
  const isCommon = clouds.every(({ toPrevious }) => toPrevious.equals(clouds[0].toPrevious));
  return {
    toClip: product(current.clipMatrix, ndcToWorld),
    boxes: clouds
      .sort((a, b) => Math.abs(b.box.determinant()) - Math.abs(a.box.determinant()))
      .slice(0, isCommon ? 1 : MOST_MOTIONS)
      .map(({ box, toPrevious }) => ({
        toBox: product(box.invert(), ndcToWorld),
        toPreviousClip: product(previous.clipMatrix, toPrevious, ndcToWorld),
      })),
  };
}

function product(...matrices: readonly Matrix4[]): Matrix4 {
  return matrices.reduce((all, next) => all.multiply(next), new Matrix4());
}

/** Returns the matrix that moves a model's points back; the exact identity at rest. */
function moved(now: Matrix4, before: Matrix4): Matrix4 {
  const isStill = now.equals(before) || now.determinant() === 0;
  return isStill ? new Matrix4() : new Matrix4().multiplyMatrices(before, now.clone().invert());
}

/** Returns the matrix from −1…1 to a cloud's box in world space. */
function boxMatrix({ modelMatrix, bounds }: CloudPose): Matrix4 {
  const half = bounds.getSize(new Vector3()).multiplyScalar(0.5);
  const least = Math.max(LEAST_THICKNESS * half.length(), Number.EPSILON);
  half.max(new Vector3(least, least, least));
  const box = new Matrix4().makeScale(half.x, half.y, half.z);
  return box.setPosition(bounds.getCenter(new Vector3())).premultiply(modelMatrix);
}
