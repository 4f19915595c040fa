import { type AccuracySettings, layerSize } from './accuracy.ts';
import { type EffectSet, effectSetOf } from './effects/effect-set.ts';
import { usesOf } from './effects/effects.ts';
import type { CloudPages } from './scene/cloud-planes.ts';
import { keyBitsFor } from './scene/key-bits.ts';
import type { SplatCloud } from './scene/splat-cloud.ts';
import type { ShDegree } from './scene/splat-set.ts';
import type { ViewFrame } from './scene/view-frame.ts';
import { visibleCapacity } from './scene/visible-capacity.ts';
import type { RasterizeDepth } from './stages/rasterize.ts';

/** Everything that decides which shaders a frame runs and how large its buffers are. */
export interface FrameShape {
  /** In the order in which equal depths are drawn; a cloud may occur more than once. */
  readonly clouds: readonly SplatCloud[];
  /** Of each cloud what is drawn of it: as near to `accuracy` as it can be had at this moment. */
  readonly planes: readonly CloudPages[];
  /** Of each cloud the effects that it is drawn with. */
  readonly effects: readonly EffectSet[];
  /** Of each cloud the degree of spherical harmonics that is evaluated. */
  readonly shDegrees: readonly ShDegree[];
  /** Of each cloud whether its colours are kept for frames from the same viewpoint. */
  readonly keepsColors: readonly boolean[];
  readonly isOrthographic: boolean;
  readonly accuracy: AccuracySettings;
  /** Most workgroups in one dimension of a dispatch. */
  readonly dispatchRow: number;
  /** Most splats that may be visible: buffers for visible splats have room for as many. */
  readonly visibleCapacity: number;
  /** Bits that the sort keys of this frame may differ in, at most 32. */
  readonly keyBits: number;
  /** Whether that is fewer than depths may differ in: keys keep `sortKeyBits` of them. */
  readonly shortensKeys: boolean;
  /** In another renderer's picture: what its depth asks of the splats. Null where nothing could hide them. */
  readonly depth: RasterizeDepth | null;
}

/**
 * The shape of a frame that depends on none before it: it keeps no colours.
 *
 * @param current shape of the last picture: its buffers are kept as long as they are large enough.
 */
export function shapeOf(
  frame: ViewFrame,
  { accuracy, dispatchRow, depth }: Pick<FrameShape, 'accuracy' | 'dispatchRow' | 'depth'>,
  current: FrameShape | undefined,
): FrameShape {
  const { camera } = frame;
  const clouds = frame.clouds.map(({ cloud }) => cloud);
  const isSameClouds =
    clouds.length === current?.clouds.length && clouds.every((cloud, i) => cloud === current.clouds[i]);
  const depthBits = keyBitsFor(camera, frame.clouds);
  const layer = { ...frame, ...layerSize(frame, accuracy) };
  return {
    clouds,
    planes: clouds.map((cloud) => cloud.pagesFor(accuracy)),
    effects: frame.clouds.map((instance) => effectSetOf(usesOf(instance))),
    shDegrees: frame.clouds.map(
      ({ cloud, shDegree = 3 }) => Math.min(accuracy.shDegree, shDegree, cloud.shDegree) as ShDegree,
    ),
    keepsColors: clouds.map(() => false),
    isOrthographic: camera.projectionMatrix[11] === 0,
    accuracy,
    dispatchRow,
    visibleCapacity: visibleCapacity(layer, accuracy.alphaCutoff, isSameClouds ? current.visibleCapacity : 0),
    keyBits: Math.min(depthBits, accuracy.sortKeyBits),
    shortensKeys: accuracy.sortKeyBits < depthBits,
    depth,
  };
}

/** Whether splats are blended in a layer smaller than the picture. */
export function isScaled({ accuracy }: Pick<FrameShape, 'accuracy'>): boolean {
  return accuracy.resolutionScale < 1;
}

/** Whether a frame of one shape can be drawn with the buffers of the other, though maybe by other shaders. */
export function hasSameBuffers(a: FrameShape, b: FrameShape): boolean {
  return (
    a.keyBits === b.keyBits &&
    a.visibleCapacity === b.visibleCapacity &&
    a.accuracy.recordPrecision === b.accuracy.recordPrecision &&
    a.clouds.length === b.clouds.length &&
    a.clouds.every((cloud, i) => cloud === b.clouds[i]) &&
    (a.depth === null) === (b.depth === null)
  );
}

/** Whether buffers, bindings and shaders of one do for the other. */
export function isSameShape(a: FrameShape, b: FrameShape): boolean {
  return (
    hasSameBuffers(a, b) &&
    a.isOrthographic === b.isOrthographic &&
    a.shortensKeys === b.shortensKeys &&
    a.accuracy === b.accuracy &&
    a.planes.every((planes, i) => planes === b.planes[i]) &&
    a.effects.every((effects, i) => effects === b.effects[i]) &&
    a.shDegrees.every((degree, i) => degree === b.shDegrees[i]) &&
    a.keepsColors.every((keeps, i) => keeps === b.keepsColors[i]) &&
    JSON.stringify(a.depth) === JSON.stringify(b.depth)
  );
}
