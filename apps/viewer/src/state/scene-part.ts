import type { UpAxis } from './up-axis.ts';
import type { Vec3 } from './vec3.ts';

/** Place of a file of the scene: set upright, scaled and turned about its middle, then moved. */
export interface Placement {
  /** Scene units, along the scene's own axes. */
  readonly move: Vec3;
  /** Degrees about the scene's x, then y, then z axis. */
  readonly turnDegrees: Vec3;
  /** Factor along all axes, above 0. */
  readonly scale: number;
  /** Centre of scaling and turning: its middle once it is upright, before it is moved. */
  readonly about: Vec3;
  /** The axis of its own that comes to point along `sceneUp`, by a turn about its file's origin. */
  readonly up: UpAxis;
  /** The axis of the scene's own that points up. */
  readonly sceneUp: UpAxis;
}

/** How a file of the scene is drawn. */
export interface PartLook {
  readonly isHidden: boolean;
  /** Multiplies the opacity of every splat, 0…1. */
  readonly opacity: number;
  /** Null if it stands as it was saved. */
  readonly placement: Placement | null;
  /** The matrix of `placement`, column-major; absent without one. */
  readonly modelMatrix?: ArrayLike<number>;
}

/** Look of a file that was opened. */
export const PLAIN_LOOK: PartLook = { isHidden: false, opacity: 1, placement: null };

/** A file of the scene, as panels see it. */
export interface ScenePartSummary {
  /** Stays with the file while it is in the scene, also after the device was lost. */
  readonly key: number;
  readonly title: string;
  readonly splats: number;
  /** See `cloudKeys`. */
  readonly cloudKeys: readonly string[];
  readonly look: PartLook;
  /** Whether it may stand elsewhere: hard cases are shown as they are. */
  readonly canPlace: boolean;
  /** The axis of its own that points up, as far as its file tells. */
  readonly ownUp: UpAxis;
  /** The middle of its bounds without stray splats, as it was saved. */
  readonly middle: Vec3;
  /** Radius of a sphere around its bounds without stray splats, in its own units. */
  readonly radius: number;
}

/** A file that is to be opened after the one that is being read. */
export interface WaitingPart {
  readonly key: number;
  readonly title: string;
}
