import {
  type AccuracySettings,
  DILATION_PX2,
  layerSize,
  resolveAccuracy,
  type SizePx,
} from '../data/accuracy/accuracy.ts';
import { type Camera, projectionOf } from '../data/camera/camera.ts';
import { cloudView } from '../data/camera/cloud-view.ts';
import { orderedBits, shortDepthKey, sortDistance } from '../data/layout/depth-key.ts';
import { identity4, type Vec3 } from '../data/math/mat4.ts';
import { dropNonFinite } from '../data/packing/drop-non-finite.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import { mortonOrder, permuteSplats } from '../data/packing/morton-order.ts';
import { asksForDistance, type SortBy } from '../data/splats/sort-by.ts';
import type { ShDegree, SplatSet } from '../data/splats/splat-set.ts';
import type { EffectUse } from '../gpu/effects/effect.ts';
import { usesOf } from '../gpu/effects/effect-uses.ts';
import { cullSplat, type VisibleSplat } from './cull-splats.ts';
import { type ReferenceFunction, referencesOf } from './effects/references.ts';
import { splatColor } from './project.ts';
import { noteMedianDepth, type ReferenceImage, rasterizeSplat } from './rasterize.ts';
import { upscale } from './upscale.ts';
import { sortDepth } from './wide-keys.ts';

/** What `renderReference` draws. */
export interface ReferenceFrame {
  readonly clouds: readonly {
    readonly set: SplatSet<Harmonics>;
    readonly modelMatrix?: ArrayLike<number>;
    /** Multiplies every splat's opacity, 0…1; default 1. */
    readonly opacity?: number;
    /** As in a frame request. */
    readonly shDegree?: ShDegree;
    /** As in a frame request. */
    readonly effects?: readonly EffectUse[];
  }[];
  /** References of effects from outside this package, by name. */
  readonly effectReferences?: Readonly<Record<string, ReferenceFunction>>;
  /** As in a frame request. */
  readonly sortBy?: SortBy;
  readonly camera: Camera;
  readonly widthPx: number;
  readonly heightPx: number;
  /** Host's view depth per pixel, top row first; Infinity where the host drew nothing. */
  readonly hostDepths?: ArrayLike<number>;
  /** Default: those of the preset `reference`. There are no precisions: everything is float64. */
  readonly settings?: Partial<
    Pick<AccuracySettings, 'alphaCutoff' | 'sortKeyBits' | 'extent' | 'culling' | 'resolutionScale'>
  > & {
    /** Default 0.3 px². */
    readonly dilationPx2?: number;
  };
}

export interface RenderedReference extends ReferenceImage {
  readonly visibleSplats: number;
  /** View depth of the splats per pixel, weighted like their colours; only with `hostDepths`. */
  readonly depths?: Float64Array;
  /**
   * Median view depth per pixel, times the pixel's opacity: that of the splat that makes it more
   * than half covered, counted from the nearest; only with `hostDepths`.
   */
  readonly medianDepths?: Float64Array;
}

interface DrawnSplat extends VisibleSplat {
  /** Sort key of the splats: depth, or the square of the distance from the camera. */
  readonly sortDepth: number;
  readonly color: Vec3;
}

/**
 * Renders the reference: the image that a frame must match, in float64 on the CPU, every splat in
 * exact order of depth or distance, ties in storage order (Morton order, file order among equal
 * codes, clouds in the order given). Takes seconds for a million splats.
 */
export function renderReference(frame: ReferenceFrame): RenderedReference {
  const settings = { ...resolveAccuracy('reference'), dilationPx2: DILATION_PX2, ...frame.settings };
  const layer = layerSize(frame, settings);
  const hostDepths = frame.hostDepths && nearestValues(frame.hostDepths, frame, layer);
  const image = renderLayer({ ...frame, ...layer, hostDepths }, settings);
  if (settings.resolutionScale === 1) return image;
  const { widthPx, heightPx } = frame;
  return {
    ...image,
    widthPx,
    heightPx,
    data: upscale(image.data, layer, frame),
    ...(image.depths && { depths: upscale(image.depths, layer, frame) }),
    ...(image.medianDepths && { medianDepths: upscale(image.medianDepths, layer, frame) }),
  };
}

/** Samples an image of size `from` at the middles of the pixels of a smaller one. */
function nearestValues(values: ArrayLike<number>, from: SizePx, to: SizePx): Float64Array {
  return Float64Array.from({ length: to.widthPx * to.heightPx }, (_, pixel) => {
    const column = Math.floor((((pixel % to.widthPx) + 0.5) * from.widthPx) / to.widthPx);
    const row = Math.floor(((Math.floor(pixel / to.widthPx) + 0.5) * from.heightPx) / to.heightPx);
    return values[row * from.widthPx + column];
  });
}

type ReferenceSettings = Required<NonNullable<ReferenceFrame['settings']>>;

/** Renders the layer: the image at the size that splats are blended at. */
function renderLayer(frame: ReferenceFrame, settings: ReferenceSettings): RenderedReference {
  const { camera, widthPx, heightPx, hostDepths, sortBy } = frame;
  const { alphaCutoff } = settings;
  const projection = projectionOf(camera, widthPx, heightPx);
  const image = { widthPx, heightPx, data: new Float64Array(4 * widthPx * heightPx) };
  const files = frame.clouds.map(({ set: { fileFacts = null } }) => ({ cloud: { facts: { fileFacts } } }));
  const isByDistance = !projection.isOrthographic && asksForDistance({ sortBy, clouds: files });
  const drawn: DrawnSplat[] = [];
  for (const instance of frame.clouds) {
    const { set, modelMatrix = identity4(), shDegree = 3 } = instance;
    const finite = dropNonFinite(set);
    const stored = permuteSplats(finite, mortonOrder(finite.positions, finite.count));
    const view = cloudView(camera.viewMatrix, modelMatrix, stored.origin, projection.isOrthographic);
    const place = { modelMatrix, origin: stored.origin, viewMatrix: camera.viewMatrix };
    const facts = { isAntialiased: set.isAntialiased ?? null };
    const effects = referencesOf(usesOf({ ...instance, cloud: { facts } }), place, frame.effectReferences);
    for (let index = 0; index < stored.count; index++) {
      const visible = cullSplat(stored, index, view, projection, { ...settings, effects });
      if (!visible) continue;
      const color = splatColor(stored, index, view, shDegree, visible, effects);
      drawn.push({ ...visible, sortDepth: sortDepth(visible.centerView, isByDistance), color });
    }
  }
  const values = () => new Float64Array(widthPx * heightPx);
  const depths = hostDepths && { host: hostDepths, splats: values(), medians: values() };
  const keyed = (depth: number) => (isByDistance ? sortDistance(Math.sqrt(depth), camera.near) : depth);
  const ordered = backToFront(drawn, settings.sortKeyBits, keyed);
  for (const splat of ordered) rasterizeSplat(image, splat, splat.color, alphaCutoff, depths);
  const rendered = { ...image, visibleSplats: drawn.length };
  if (!depths) return rendered;
  const transmittances = values().fill(1);
  for (const splat of ordered.toReversed())
    noteMedianDepth(transmittances, image, splat, alphaCutoff, depths);
  const medianDepths = depths.medians.map((depth, pixel) => depth * image.data[4 * pixel + 3]);
  return { ...rendered, depths: depths.splats, medianDepths };
}

/** Sorts, stably, by depth or distance or, at fewer than 32 bits, by the GPU's keys of `keyed`. */
function backToFront(
  drawn: readonly DrawnSplat[],
  sortKeyBits: number,
  keyed: (sortDepth: number) => number,
): readonly DrawnSplat[] {
  if (sortKeyBits >= 32) return drawn.toSorted((a, b) => b.sortDepth - a.sortDepth);
  const bits = drawn.map(({ sortDepth }) => orderedBits(keyed(sortDepth)));
  const farthest = bits.reduce((most, each) => Math.max(most, each), 0);
  const nearest = bits.reduce((least, each) => Math.min(least, each), farthest);
  return drawn
    .map((splat) => ({ splat, key: shortDepthKey(keyed(splat.sortDepth), farthest, nearest, sortKeyBits) }))
    .sort((a, b) => a.key - b.key)
    .map(({ splat }) => splat);
}
