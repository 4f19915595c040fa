import { type AccuracySettings, layerSize, type SizePx } from '../accuracy/accuracy.ts';
import { type Camera, type Projection, projectionOf } from '../camera/camera.ts';
import type { RasterizeDepth } from '../stages/rasterize.ts';
import { type CloudPlan, cloudShape, planCloud } from './cloud-plan.ts';
import type { FrameRequest } from './frame-request.ts';
import { type FrameOutput, type FrameShape, isSameShape, type OmittableEffect } from './frame-shape.ts';
import { keyBitsFor } from './key-bits.ts';
import { visibleCapacity } from './visible-capacity.ts';

/**
 * Everything that follows from a frame request, worked out once per frame and never changed: what is written to the GPU, which
 * shaders run, and whether anything differs from the frame before are all read from here.
 */
export interface FramePlan {
  /** As the caller gave it, its lists copied. */
  readonly request: FrameRequest;
  /** With matrices of its own: callers may write into theirs. */
  readonly camera: Camera;
  /** Size of the layer that splats are blended in. */
  readonly layer: SizePx;
  /** Onto that layer. */
  readonly projection: Projection;
  /** In the request's order. */
  readonly clouds: readonly CloudPlan[];
  readonly shape: FrameShape;
}

/** What a plan follows from besides the request. */
export interface PlanOptions {
  /** One object for equal settings. */
  readonly accuracy: AccuracySettings;
  readonly dispatchRow: number;
  readonly depth: RasterizeDepth | null;
  /** One object per view. */
  readonly output: FrameOutput;
  /** Left out, called for or not. */
  readonly omitted: readonly OmittableEffect[];
  /** The frame before: its shape is kept while nothing of it changes, its buffers while they are large enough. */
  readonly last: FramePlan | null;
}

/**
 * The plan of a frame. It keeps no colours: see `withKeptColors`.
 *
 * @throws InvalidArgumentError naming the cloud, for effects that do not go together; what a caller's own effect throws.
 */
export function planFrame(request: FrameRequest, options: PlanOptions): FramePlan {
  const { accuracy, dispatchRow, depth, output, omitted, last } = options;
  const camera = copied(request.camera);
  const layer = layerSize(request, accuracy);
  const projection = projectionOf(camera, layer.widthPx, layer.heightPx);
  const clouds = request.clouds.map((instance) => planCloud(instance, camera, projection, accuracy));
  const depthBits = keyBitsFor(camera, clouds);
  const shape: FrameShape = {
    clouds: clouds.map((cloud) => cloudShape(cloud, accuracy, omitted)),
    isOrthographic: projection.isOrthographic,
    accuracy,
    dispatchRow,
    visibleCapacity: visibleCapacity(
      clouds,
      last && isOfSameClouds(last, clouds) ? last.shape.visibleCapacity : 0,
    ),
    keyBits: Math.min(depthBits, accuracy.sortKeyBits),
    shortensKeys: accuracy.sortKeyBits < depthBits,
    depth,
    output,
  };
  const plan = {
    request: { ...request, clouds: clouds.map(({ instance }) => instance) },
    camera,
    layer,
    projection,
    clouds,
  };
  return { ...plan, shape: last && isSameShape(last.shape, shape) ? last.shape : shape };
}

/** The same frame with the colours of these clouds kept; the shape of `last` where nothing else differs from it. */
export function withKeptColors(
  plan: FramePlan,
  keeps: readonly boolean[],
  last: FramePlan | null,
): FramePlan {
  const clouds = plan.shape.clouds.map(
    ({ cloud, planes, effects, shDegree, isIsotropic, hasFaintSplats }, i) => ({
      cloud,
      planes,
      effects,
      shDegree,
      isIsotropic,
      hasFaintSplats,
      keepsColors: keeps[i],
    }),
  );
  const shape = { ...plan.shape, clouds };
  return { ...plan, shape: last && isSameShape(last.shape, shape) ? last.shape : shape };
}

function copied(camera: Camera): Camera {
  return {
    ...camera,
    viewMatrix: new Float64Array(camera.viewMatrix),
    projectionMatrix: new Float64Array(camera.projectionMatrix),
  };
}

function isOfSameClouds({ shape }: FramePlan, clouds: readonly CloudPlan[]): boolean {
  return (
    clouds.length === shape.clouds.length &&
    clouds.every(({ instance }, i) => instance.cloud === shape.clouds[i].cloud)
  );
}
