import type { CloudPages } from '../../clouds/cloud-planes.ts';
import type { Levels } from '../../clouds/levels/levels.ts';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import type { AccuracySettings, FrameRasterizer } from '../../data/accuracy/accuracy.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import type { EffectSet } from '../../gpu/effects/effect-set.ts';
import type { StorableCanvasFormat } from '../../stages/composite/composite.ts';
import type { RasterizeDepth } from '../../stages/quads/quads.ts';
import { pairSortShapeFor, type SortDevice, type SortShape, sortShapeFor } from '../../stages/sort/sort.ts';

/** Everything about one cloud that decides a frame's shaders and the size of its buffers. */
export interface CloudShape {
  readonly cloud: SplatCloud;
  /** The planes to draw: the cloud's planes whose precision is nearest to the frame's accuracy. */
  readonly planes: CloudPages;
  /** The cloud's levels of detail; null if the cloud is drawn in full. */
  readonly levels: Levels | null;
  /** See `CloudPlan`. */
  readonly isTouched: boolean;
  readonly effects: EffectSet;
  /** How many times it is drawn together; null: it is drawn once, without instances. */
  readonly instanceCount: number | null;
  /** Degree of spherical harmonics to evaluate. */
  readonly shDegree: ShDegree;
  /** Whether all splats are spheres, even after effects: shaders then ignore their rotations. */
  readonly isIsotropic: boolean;
}

/** Where a frame's image goes. */
export type FrameOutput =
  /** Stays in a texture, to be read back or compared on the GPU. */
  | { readonly kind: 'image' }
  | {
      readonly kind: 'canvas';
      readonly format: GPUTextureFormat;
      /** The format, if compute shaders may write the canvas. */
      readonly storable: StorableCanvasFormat | null;
    }
  /** Into another renderer's frame. */
  | { readonly kind: 'host' };

/** Everything that decides a frame's shaders and buffer sizes. One object until it changes. */
export interface FrameShape {
  /** In the request's order; a cloud may occur more than once. */
  readonly clouds: readonly CloudShape[];
  readonly isOrthographic: boolean;
  /** Whether splats are sorted by distance from the camera, not by depth: only with perspective. */
  readonly sortsByDistance: boolean;
  /** Whether merged splats are drawn, whose opacity may exceed 1. */
  readonly isStacked: boolean;
  /** Whether a budget shifts the thresholds of the cuts. */
  readonly isBudgeted: boolean;
  readonly accuracy: AccuracySettings;
  /** Most workgroups in one dimension of a dispatch. */
  readonly dispatchRow: number;
  readonly sortDevice: SortDevice;
  /** Upper bound of the number of visible splats, and the size of the buffers for them. */
  readonly visibleCapacity: number;
  /** Number of bits in which sort keys of this frame can differ; above 32 for wide keys. */
  readonly keyBits: number;
  /** Whether depths can differ in more bits than `keyBits`: keys keep `sortKeyBits` of them. */
  readonly shortensKeys: boolean;
  /** How the host's depth hides splats, and how theirs is written; null if neither. */
  readonly depth: RasterizeDepth | null;
  /** Whether the finished splats are blended over the host's image in part. */
  readonly isFaded: boolean;
  readonly output: FrameOutput;
  /** Rasteriser of the splats. Even with tiles, quads draw frames without room for their splats. */
  readonly rasterizer: FrameRasterizer;
  /** Bins of the layer; 0 for quads. */
  readonly binCount: number;
}

/** Whether splats are blended in a layer smaller than the image. */
export function isScaled({ accuracy }: Pick<FrameShape, 'accuracy'>): boolean {
  return accuracy.resolutionScale < 1;
}

/** Whether splats are sorted by float64, with keys of two words. */
export function hasWideKeys({ keyBits }: Pick<FrameShape, 'keyBits'>): boolean {
  return keyBits > 32;
}

/** Sort of the visible splats by depth. */
export function depthSortShape({ keyBits, sortDevice }: FrameShape): SortShape {
  return sortShapeFor(keyBits, sortDevice);
}

/** Sort of the pairs by bin; one more key than bins, for pairs too many. */
export function pairSortShape({ binCount, sortDevice }: FrameShape): SortShape {
  return pairSortShapeFor(Math.ceil(Math.log2(binCount + 1)), sortDevice);
}

/** tile-plan and tile-emit do part of the work of that sort. */
export const PAIR_SORT_OPTIONS = { firstCounts: 'given' } as const;

/** Whether frames of both shapes can be pre-processed with the same buffers, if not shaders. */
export function hasSameBuffers(a: FrameShape, b: FrameShape): boolean {
  return (
    a.visibleCapacity === b.visibleCapacity &&
    a.accuracy.recordPrecision === b.accuracy.recordPrecision &&
    a.clouds.length === b.clouds.length &&
    a.clouds.every(
      ({ cloud, planes, levels, instanceCount, effects }, i) =>
        cloud === b.clouds[i].cloud &&
        levels === b.clouds[i].levels &&
        // A streamed cloud gets further pages as it grows.
        planes.pages.length === b.clouds[i].planes.pages.length &&
        instanceCount === b.clouds[i].instanceCount &&
        // The size of batches follows from the size of effect parameters.
        (instanceCount === null || effects === b.clouds[i].effects),
    )
  );
}

/** Whether frames of both shapes can use the same buffers, bindings and shaders. */
export function isSameShape(a: FrameShape, b: FrameShape): boolean {
  const { clouds, depth } = b;
  return (
    hasSameFields({ ...a, clouds, depth }, b) &&
    hasSameFields(a.depth, depth) &&
    a.clouds.length === clouds.length &&
    a.clouds.every((cloud, i) => hasSameFields(cloud, clouds[i]))
  );
}

/** Caches the result of `make` by shape, so that frames of one shape share it. */
export function perShape<Made>(make: (shape: FrameShape) => Made): (shape: FrameShape) => Made {
  const made = new WeakMap<FrameShape, Made>();
  return (shape) => {
    let known = made.get(shape);
    if (known === undefined) {
      known = make(shape);
      made.set(shape, known);
    }
    return known;
  };
}
