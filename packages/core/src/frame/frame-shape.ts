import { type AccuracySettings, layerSize } from '../accuracy/accuracy.ts';
import type { CloudPages } from '../clouds/cloud-planes.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { type EffectSet, effectSetOf, hasHook } from '../effects/effect-set.ts';
import { CLOUD_EFFECTS, usesOf } from '../effects/effects.ts';
import type { ShDegree } from '../splats/splat-set.ts';
import type { RasterizeDepth } from '../stages/rasterize.ts';
import type { CloudInstance, ViewFrame } from './frame-request.ts';
import { keyBitsFor } from './key-bits.ts';
import { visibleCapacity } from './visible-capacity.ts';

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
  /** Of each cloud whether all splats are balls, after its effects as well: their rotations are not looked at. */
  readonly isIsotropic: readonly boolean[];
  /** Of each cloud whether splats may be fainter than the cutoff, after its effects as well: each is tested. */
  readonly hasFaintSplats: readonly boolean[];
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

/** Effects that are found and can be left out of a picture: for measurements of what they cost. */
export type OmittableEffect = 'isotropic' | 'faint-splats';

/**
 * The shape of a frame that depends on none before it: it keeps no colours.
 *
 * @param omitted is left out, called for or not.
 * @param current shape of the last picture: its buffers are kept as long as they are large enough.
 */
export function shapeOf(
  frame: ViewFrame,
  { accuracy, dispatchRow, depth }: Pick<FrameShape, 'accuracy' | 'dispatchRow' | 'depth'>,
  omitted: readonly OmittableEffect[],
  current: FrameShape | undefined,
): FrameShape {
  const { camera } = frame;
  const ofClouds = cloudShapes(frame.clouds, accuracy, omitted);
  const { clouds } = ofClouds;
  const isSameClouds =
    clouds.length === current?.clouds.length && clouds.every((cloud, i) => cloud === current.clouds[i]);
  const depthBits = keyBitsFor(camera, frame.clouds);
  const layer = { ...frame, ...layerSize(frame, accuracy) };
  return {
    ...ofClouds,
    isOrthographic: camera.projectionMatrix[11] === 0,
    accuracy,
    dispatchRow,
    visibleCapacity: visibleCapacity(layer, accuracy.alphaCutoff, isSameClouds ? current.visibleCapacity : 0),
    keyBits: Math.min(depthBits, accuracy.sortKeyBits),
    shortensKeys: accuracy.sortKeyBits < depthBits,
    depth,
  };
}

type CloudShapes = Pick<
  FrameShape,
  'clouds' | 'planes' | 'effects' | 'shDegrees' | 'isIsotropic' | 'hasFaintSplats' | 'keepsColors'
>;

/** What a shape has of each cloud, by itself: no colours are kept. */
export function cloudShapes(
  instances: readonly CloudInstance[],
  accuracy: AccuracySettings,
  omitted: readonly OmittableEffect[] = [],
): CloudShapes {
  const effects = instances.map((instance) => effectSetOf(usesOf(instance)));
  return {
    clouds: instances.map(({ cloud }) => cloud),
    planes: instances.map(({ cloud }) => cloud.pagesFor(accuracy)),
    effects,
    shDegrees: instances.map(
      ({ cloud, shDegree = 3 }) => Math.min(accuracy.shDegree, shDegree, cloud.shDegree) as ShDegree,
    ),
    isIsotropic: instances.map(
      ({ cloud }, i) => !omitted.includes('isotropic') && isIsotropic(cloud, effects[i]),
    ),
    hasFaintSplats: instances.map(
      ({ cloud }, i) => !omitted.includes('faint-splats') && hasFaintSplats(cloud, effects[i], accuracy),
    ),
    keepsColors: instances.map(() => false),
  };
}

/** Effects of this package leave balls round; of those of callers' own nothing is known. */
function isIsotropic({ facts }: SplatCloud, { effects }: EffectSet): boolean {
  return (
    facts.isIsotropic &&
    effects.every((effect) => effect.hooks.splat === undefined || CLOUD_EFFECTS.includes(effect))
  );
}

/** Opacities are packed in steps as large as this. */
const OPACITY_STEP = 1 / 65535;

/** What opacity hooks make fainter is tested by itself. */
function hasFaintSplats(
  { facts }: SplatCloud,
  effects: EffectSet,
  { alphaCutoff }: AccuracySettings,
): boolean {
  return hasHook(effects, 'splat') || facts.minOpacity - OPACITY_STEP < alphaCutoff;
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
    a.isIsotropic.every((isBalls, i) => isBalls === b.isIsotropic[i]) &&
    a.hasFaintSplats.every((isTested, i) => isTested === b.hasFaintSplats[i]) &&
    JSON.stringify(a.depth) === JSON.stringify(b.depth)
  );
}
