import { type AccuracySettings, layerSize, resolveAccuracy, type SizePx } from '../data/accuracy/accuracy.ts';
import { type Camera, type Projection, projectionOf } from '../data/camera/camera.ts';
import { type CloudView, cloudView } from '../data/camera/cloud-view.ts';
import { orderedBits, shortDepthKey, sortDistance, wideKey } from '../data/layout/depth-key.ts';
import { identity4 } from '../data/math/mat4.ts';
import { dropNonFinite } from '../data/packing/drop-non-finite.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import { mortonSteps } from '../data/packing/morton-order.ts';
import { asksForDistance, type SortBy } from '../data/splats/sort-by.ts';
import type { ShDegree, SplatSet } from '../data/splats/splat-set.ts';
import { Turns } from '../data/turns.ts';
import { motion } from '../features/motion/motion.gpu.ts';
import { timeRangeOf } from '../features/motion/splat-motion.data.ts';
import { dilationOf, usesOf } from '../gpu/effects/cloud-effects.ts';
import type { EffectUse } from '../gpu/effects/effect.ts';
import { upscale } from '../stages/compose/compose.reference.ts';
import { cullSplat } from '../stages/cull/cull.reference.ts';
import { splatColor } from '../stages/project/project.reference.ts';
import { noteMedianDepth, type ReferenceImage, rasterizeSplat } from '../stages/quads/quads.reference.ts';
import { radixSort } from '../stages/sort/sort.reference.ts';
import { sortDepth } from '../stages/wide-keys/wide-keys.reference.ts';
import type { EffectReference } from './effects/effect-reference.ts';
import { type ReferenceFunction, referencesOf } from './effects/references.ts';

/** What `renderReference` draws. */
export interface ReferenceFrame {
  readonly clouds: readonly {
    readonly set: SplatSet<Harmonics>;
    readonly modelMatrix?: ArrayLike<number>;
    /** Multiplies every splat's opacity, 0…1; default 1. */
    readonly opacity?: number;
    /** As in a frame request. */
    readonly time?: number;
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
  /** Default: the settings of the preset `reference`. Precisions do not apply: everything is float64. */
  readonly settings?: Partial<
    Pick<AccuracySettings, 'alphaCutoff' | 'sortKeyBits' | 'extent' | 'culling' | 'resolutionScale'>
  > & {
    /** Default: as each cloud's effects ask for. */
    readonly dilationPx2?: number;
  };
}

export interface RenderedReference extends ReferenceImage {
  readonly visibleSplats: number;
  /** View depth of the splats per pixel, weighted like their colours; only with `hostDepths`. */
  readonly depths?: Float64Array;
  /**
   * Median view depth per pixel, times the pixel's opacity. The median splat is the first, nearest to
   * farthest, at which the pixel is more than half covered. Only with `hostDepths`.
   */
  readonly medianDepths?: Float64Array;
}

/** Scheduling, progress and cancellation of long work. */
export interface ReferenceTurns {
  /** Cancels the rendering. */
  readonly signal?: AbortSignal;
  /** Called with the completed part of the work, 0…1. */
  readonly onProgress?: (fraction: number) => void;
}

/** Drawing in short steps; yields how much is done after each, from 0 to 1. */
type Steps<Result> = Generator<number, Result, void>;

/**
 * Renders the reference: the image that a frame must match, in float64 on the CPU, every splat in
 * exact order of depth or distance (`sortDepth`), ties in storage order (Morton order, file order
 * among equal codes, clouds in the order given). Takes seconds for a million splats, and besides
 * the sets and the image some 40 bytes per splat.
 */
export function renderReference(frame: ReferenceFrame): RenderedReference {
  const steps = renderSteps(frame);
  for (;;) {
    const { done, value } = steps.next();
    if (done) return value;
  }
}

/**
 * As `renderReference`, with turns for the event loop.
 *
 * @throws the reason of the signal, once it is aborted.
 * @example
 * const { data } = await renderReferenceInTurns(frame, { signal, onProgress: (part) => show(part) });
 */
export async function renderReferenceInTurns(
  frame: ReferenceFrame,
  { signal, onProgress }: ReferenceTurns = {},
): Promise<RenderedReference> {
  const turns = new Turns(signal);
  const steps = renderSteps(frame);
  for (;;) {
    const { done, value } = steps.next();
    if (done) return value;
    onProgress?.(value);
    await turns.give();
  }
}

function* renderSteps(frame: ReferenceFrame): Steps<RenderedReference> {
  const settings = { ...resolveAccuracy('reference'), ...frame.settings };
  const layer = layerSize(frame, settings);
  const hostDepths = frame.hostDepths && nearestValues(frame.hostDepths, frame, layer);
  const image = yield* layerSteps({ ...frame, ...layer, hostDepths }, settings);
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

type ReferenceSettings = AccuracySettings & Pick<NonNullable<ReferenceFrame['settings']>, 'dilationPx2'>;

/** A cloud as one frame draws it. */
interface PlacedCloud {
  /** Without splats that are not finite. */
  readonly set: SplatSet<Harmonics>;
  /** Where the set holds each splat, in storage order. A copy in that order would hold it twice. */
  readonly rows: Uint32Array;
  /** Number of splats in the clouds before. */
  readonly first: number;
  readonly view: CloudView;
  readonly effects: readonly EffectReference[];
  readonly dilationPx2: number;
  readonly shDegree: ShDegree;
}

/** Splats between two yields. */
const STEP_SPLATS = 1 << 10;
/** How much of the work storage order, culling and drawing are taken to be, one after another. */
const SHARES = [0, 0.1, 0.4, 1] as const;

/** Passes on a part of the work as part of the whole. */
function* within<Result>(steps: Steps<Result>, from: number, to: number): Steps<Result> {
  for (;;) {
    const { done, value } = steps.next();
    if (done) return value;
    yield from + (to - from) * value;
  }
}

/** Calls `work` with each number below `count`. */
function* overSplats(count: number, work: (i: number) => void): Steps<void> {
  for (let i = 0; i < count; i++) {
    work(i);
    if (i % STEP_SPLATS === STEP_SPLATS - 1) yield (i + 1) / count;
  }
}

/**
 * Renders the layer: the image at the size that splats are blended at. Each visible splat is culled
 * twice, before the sort and for drawing, because a stored result would take a kilobyte.
 */
function* layerSteps(frame: ReferenceFrame, settings: ReferenceSettings): Steps<RenderedReference> {
  const { camera, widthPx, heightPx, hostDepths, sortBy } = frame;
  const { alphaCutoff } = settings;
  const projection = projectionOf(camera, widthPx, heightPx);
  const image = { widthPx, heightPx, data: new Float64Array(4 * widthPx * heightPx) };
  const files = frame.clouds.map(({ set: { fileFacts = null } }) => ({ cloud: { facts: { fileFacts } } }));
  const isByDistance = !projection.isOrthographic && asksForDistance({ sortBy, clouds: files });
  const [placing, culling, drawing, end] = SHARES;
  const clouds: PlacedCloud[] = [];
  let total = 0;
  for (const [i, instance] of frame.clouds.entries()) {
    const share = (culling - placing) / frame.clouds.length;
    const steps = placedSteps(instance, frame, projection, total);
    clouds.push(yield* within(steps, placing + i * share, placing + (i + 1) * share));
    total += clouds[i].set.count;
  }
  const cull = ({ set, rows, first, view, ...placed }: PlacedCloud, number: number) =>
    cullSplat(set, number - first, view, projection, { ...placed, ...settings }, rows[number - first]);

  const depths = new Float64Array(total);
  const numbers = new Uint32Array(total);
  let visibleSplats = 0;
  const note = (number: number) => {
    const visible = cull(cloudOf(clouds, number), number);
    if (!visible) return;
    depths[visibleSplats] = sortDepth(visible.centerView, isByDistance);
    numbers[visibleSplats++] = number;
  };
  yield* within(overSplats(total, note), culling, drawing);
  const keyed = (depth: number) => (isByDistance ? sortDistance(Math.sqrt(depth), camera.near) : depth);
  const order = backToFront(depths.subarray(0, visibleSplats), settings.sortKeyBits, keyed);

  const values = () => new Float64Array(widthPx * heightPx);
  const hosted = hostDepths && { host: hostDepths, splats: values(), medians: values() };
  const draw = (place: number) => {
    const number = numbers[order[place]];
    const cloud = cloudOf(clouds, number);
    const visible = cull(cloud, number)!;
    const { set, rows, first, view, shDegree, effects } = cloud;
    const index = number - first;
    const color = splatColor(set, index, view, shDegree, visible, effects, rows[index]);
    rasterizeSplat(image, visible, color, alphaCutoff, hosted);
  };
  yield* within(overSplats(visibleSplats, draw), drawing, end);
  const rendered = { ...image, visibleSplats };
  if (!hosted) return rendered;
  const transmittances = values().fill(1);
  for (const place of order.toReversed()) {
    const visible = cull(cloudOf(clouds, numbers[place]), numbers[place])!;
    noteMedianDepth(transmittances, image, visible, alphaCutoff, hosted);
  }
  const medianDepths = hosted.medians.map((depth, pixel) => depth * image.data[4 * pixel + 3]);
  return { ...rendered, depths: hosted.splats, medianDepths };
}

function* placedSteps(
  instance: ReferenceFrame['clouds'][number],
  { camera: { viewMatrix }, effectReferences }: ReferenceFrame,
  projection: Projection,
  first: number,
): Steps<PlacedCloud> {
  const { modelMatrix = identity4(), shDegree = 3 } = instance;
  const set = dropNonFinite(instance.set);
  const rows = yield* mortonSteps(set.positions, set.count);
  const { origin } = set;
  const view = cloudView(viewMatrix, modelMatrix, origin, projection.isOrthographic);
  const facts = { isAntialiased: set.isAntialiased ?? null };
  const range = set.motion && timeRangeOf(set.motion);
  const features = range ? [{ effectAt: (time = range[0]) => motion({ time, range }) }] : [];
  const uses = usesOf({ ...instance, cloud: { facts, features } });
  const effects = referencesOf(uses, { modelMatrix, origin, viewMatrix, projection }, effectReferences);
  return { set, rows, first, view, effects, dilationPx2: dilationOf(uses), shDegree };
}

/** The cloud that has splat `number` of the frame. */
function cloudOf(clouds: readonly PlacedCloud[], number: number): PlacedCloud {
  let [from, to] = [0, clouds.length - 1];
  while (from < to) {
    const middle = (from + to + 1) >> 1;
    if (clouds[middle].first <= number) from = middle;
    else to = middle - 1;
  }
  return clouds[from];
}

/** From here on, few passes by large tables take less time than many by small ones. */
const MANY_SPLATS = 1 << 15;

/**
 * Sorts, stably, by depth or square of the distance or, at fewer than 32 bits, by the GPU's keys of
 * `keyed`. Returns indices of `depths`.
 */
function backToFront(
  depths: Float64Array,
  sortKeyBits: number,
  keyed: (sortDepth: number) => number,
): Uint32Array {
  const count = depths.length;
  const digitBits = count < MANY_SPLATS ? 8 : 16;
  const shape = { digitBits, passes: 32 / digitBits, blockKeys: Math.max(1, count) };
  const keys = new Uint32Array(count);
  if (sortKeyBits >= 32) {
    const upperKeys = new Uint32Array(count);
    for (let i = 0; i < count; i++) {
      const { low, high } = wideKey(depths[i], 0xffffffff);
      keys[i] = low;
      upperKeys[i] = high;
    }
    return radixSort(keys, { ...shape, passes: 2 * shape.passes }, upperKeys);
  }
  let [farthest, nearest] = [0, 0xffffffff];
  for (let i = 0; i < count; i++) {
    const bits = orderedBits(keyed(depths[i]));
    farthest = Math.max(farthest, bits);
    nearest = Math.min(nearest, bits);
  }
  for (let i = 0; i < count; i++) keys[i] = shortDepthKey(keyed(depths[i]), farthest, nearest, sortKeyBits);
  return radixSort(keys, shape);
}
