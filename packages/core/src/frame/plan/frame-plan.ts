import type { SizePx } from '../../data/accuracy/accuracy.ts';
import type { Camera, Projection } from '../../data/camera/camera.ts';
import type { CloudPlan } from './cloud-plan.ts';
import type { FixedDetail } from './detail.ts';
import type { CloudInstance, FrameRequest } from './frame-request.ts';
import type { FrameShape } from './frame-shape.ts';
import type { CutBudget } from './level-cut.ts';

/**
 * Everything that follows from a frame request, worked out once per frame and never changed. The
 * data written to the GPU, the shaders that run, and the comparison with the last frame are all
 * based on it.
 */
export interface FramePlan {
  /** The caller's request, with copies of its lists. */
  readonly request: FrameRequest;
  /** The request's camera with copied matrices: callers may write into theirs. */
  readonly camera: Camera;
  /** Size of the layer that splats are blended in. */
  readonly layer: SizePx;
  /** Projection onto `layer`. */
  readonly projection: Projection;
  /** In the request's order. */
  readonly clouds: readonly CloudPlan[];
  readonly shape: FrameShape;
  /** Detail of this frame. A target's measurement may change it only for later frames. */
  readonly detail: FixedDetail;
  /** Factor of the requested width and height of `layer`, less than 1 only while something moves. */
  readonly movingScale: number;
  /** Budget of the clouds' cuts; null without one. */
  readonly budget: CutBudget | null;
  readonly needs: FrameNeeds;
  /** Of wide keys, see `wideKey`; 0 for others. */
  readonly farthestHigh: number;
  /** Whether it is drawn already: the last frame shows the same. */
  readonly isDrawn: boolean;
  /** Whether the buffers of the last frame hold this one's visible splats, in the same order. */
  readonly keepsOrder: boolean;
}

/** Needs of a frame, which change as the camera moves; buffers and shaders are made for more. */
export interface FrameNeeds {
  /** Never less than the number of visible splats. */
  readonly visibleSplats: number;
  /** Number of bits in which depths can differ: see `keyBitsFor` and `wideKeysFor`. */
  readonly depthBits: number;
}

/** The detail that a frame draws: `full` if no cloud is cut, even if limits are set. */
export function drawnDetail({ clouds, detail }: FramePlan): FixedDetail {
  return clouds.some(({ cut }) => cut) ? detail : 'full';
}

/** Whether a frame shows these clouds, in this order. */
export function showsClouds({ shape }: FramePlan, clouds: readonly CloudInstance[]): boolean {
  return (
    clouds.length === shape.clouds.length && clouds.every(({ cloud }, i) => cloud === shape.clouds[i].cloud)
  );
}
