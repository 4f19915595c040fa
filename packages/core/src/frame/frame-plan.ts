import { type AccuracySettings, type FrameRasterizer, layerSize, type SizePx } from '../accuracy/accuracy.ts';
import { type Camera, type Projection, projectionOf } from '../camera/camera.ts';
import type { BallotDevice } from '../gpu/device.ts';
import { binGrid } from '../layout/bin-grid.ts';
import { asksForDistance } from '../splats/sort-by.ts';
import type { RasterizeDepth } from '../stages/rasterize.ts';
import { type CloudPlan, cloudShape, planCloud } from './cloud-plan.ts';
import type { CloudInstance, FrameRequest } from './frame-request.ts';
import { type FrameOutput, type FrameShape, isSameShape } from './frame-shape.ts';
import { keyBitsFor } from './key-bits.ts';
import { mostDrawnSplats, mostVisibleSplats, visibleCapacity } from './visible-capacity.ts';

/**
 * Everything that follows from a frame request, worked out once per frame and never changed. The data written to the GPU,
 * the shaders that run, and the comparison with the last frame are all based on it.
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
  readonly needs: FrameNeeds;
}

/** What a frame needs, that changes as the camera moves; buffers and shaders are made for a little more. */
export interface FrameNeeds {
  /** Never less than the number of visible splats. */
  readonly visibleSplats: number;
  /** Number of bits in which depths can differ: see `keyBitsFor`. */
  readonly depthBits: number;
}

/** Everything but the request that a plan depends on. */
export interface PlanOptions {
  /** Equal settings are the same object. */
  readonly accuracy: AccuracySettings;
  readonly dispatchRow: number;
  readonly workgroupBytes: number;
  readonly hasNarrowSubgroups: boolean;
  readonly ballots: BallotDevice | null;
  readonly depth: RasterizeDepth | null;
  /** The faster rasteriser, for the setting `auto`. */
  readonly faster: FrameRasterizer;
  /** The same object for all frames of a view. */
  readonly output: FrameOutput;
  /** Whether round splats may have shaders of their own; not where these are measured. */
  readonly mayBeIsotropic: boolean;
  /** Plan of the last frame: its shape is kept until the shape changes, its buffers while they are large enough. */
  readonly last: FramePlan | null;
  /**
   * The largest needs of recent frames of the clouds of `last`. Buffers and shaders stay as they are while they were needed a
   * moment ago.
   */
  readonly recent: FrameNeeds;
}

/**
 * Plans a frame.
 *
 * @throws InvalidArgumentError naming the cloud, if its effects cannot be combined; errors of callers' own effects.
 */
export function planFrame(request: FrameRequest, options: PlanOptions): FramePlan {
  const { accuracy, dispatchRow, workgroupBytes, hasNarrowSubgroups, ballots } = options;
  const { depth, output, mayBeIsotropic, last } = options;
  const camera = copied(request.camera);
  const layer = layerSize(request, accuracy);
  const projection = projectionOf(camera, layer.widthPx, layer.heightPx);
  const { isOrthographic } = projection;
  const sortsByDistance = !isOrthographic && asksForDistance(request);
  const clouds = request.clouds.map((instance) => planCloud(instance, camera, projection, accuracy));
  const isSameScene = last !== null && showsClouds(last, request.clouds);
  const recent = isSameScene ? options.recent : { visibleSplats: 0, depthBits: 0 };
  const needs = {
    visibleSplats: mostVisibleSplats(clouds),
    depthBits: keyBitsFor(camera, clouds, sortsByDistance),
  };
  const rasterizer = rasterizerOf(options);
  const shape: FrameShape = {
    clouds: clouds.map((cloud) => cloudShape(cloud, accuracy, mayBeIsotropic)),
    isOrthographic,
    sortsByDistance,
    accuracy,
    dispatchRow,
    workgroupBytes,
    hasNarrowSubgroups,
    ballots,
    visibleCapacity: visibleCapacity(
      needs.visibleSplats,
      mostDrawnSplats(clouds),
      isSameScene ? last.shape.visibleCapacity : 0,
      recent.visibleSplats,
    ),
    // More bits than the depths need take a pass more and sort the same; other buffers and shaders take longer than that.
    keyBits: Math.min(Math.max(needs.depthBits, recent.depthBits), accuracy.sortKeyBits),
    shortensKeys: accuracy.sortKeyBits < needs.depthBits,
    depth,
    output,
    rasterizer,
    binCount: rasterizer === 'tiles' ? binCountOf(layer) : 0,
  };
  const plan: FramePlan = {
    request: { ...request, clouds: clouds.map(({ instance }) => instance) },
    camera,
    layer,
    projection,
    clouds,
    needs,
    shape,
  };
  return last && isSameShape(last.shape, shape) ? { ...plan, shape: last.shape } : plan;
}

function rasterizerOf({ accuracy, depth, faster }: PlanOptions): FrameRasterizer {
  const rasterizer = accuracy.rasterizer === 'auto' ? faster : accuracy.rasterizer;
  // Compute shaders cannot write r16float, the only depth that devices without float32-blendable blend.
  return rasterizer === 'tiles' && depth?.layerFormat !== 'r16float' ? 'tiles' : 'quads';
}

function binCountOf({ widthPx, heightPx }: SizePx): number {
  const { binColumns, binRows } = binGrid(widthPx, heightPx);
  return binColumns * binRows;
}

function copied(camera: Camera): Camera {
  return {
    ...camera,
    viewMatrix: new Float64Array(camera.viewMatrix),
    projectionMatrix: new Float64Array(camera.projectionMatrix),
    wholeProjectionMatrix: camera.wholeProjectionMatrix && new Float64Array(camera.wholeProjectionMatrix),
  };
}

/** Whether a frame shows these clouds, in this order. */
export function showsClouds({ shape }: FramePlan, clouds: readonly CloudInstance[]): boolean {
  return (
    clouds.length === shape.clouds.length && clouds.every(({ cloud }, i) => cloud === shape.clouds[i].cloud)
  );
}
