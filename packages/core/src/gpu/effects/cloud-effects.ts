import { ANTIALIAS_DILATION_PX2, DILATION_PX2 } from '../../data/accuracy/accuracy.ts';
import type { SplatReach } from '../../data/camera/frustum.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { wrongArgument } from '../../data/given.ts';
import type { GpuFields, GpuValues } from '../../data/layout/gpu-struct.ts';
import { invert3, linearPart, stretchBound } from '../../data/math/mat4.ts';
import type { CloudFacts } from '../../data/packing/cloud-facts.ts';
import { type AntialiasOptions, antialias } from './antialias/antialias.ts';
import type { BoundCloud, BoundResource, EffectPlace, EffectUse, SplatEffect } from './effect.ts';
import { placeInList } from './effect-list.ts';
import { type EffectSet, effectSetOf, packParameters } from './effect-set.ts';
import { opacity } from './opacity/opacity.ts';
import { tint } from './tint/tint.ts';

/** One effect of one cloud in one frame. */
export interface PlannedUse {
  readonly use: EffectUse;
  /** Values of the effect's parameters; null if it has none. */
  readonly values: GpuValues<GpuFields> | null;
  /** Version of the effect's selection; undefined without one. */
  readonly selectionVersion: number | undefined;
  /** Textures and buffers of the effect's own. */
  readonly resources: readonly BoundResource[];
}

const NO_RESOURCES: readonly BoundResource[] = [];

/** Effects, and sets of effects, that cannot be drawn with, and why. */
export type EffectFaults = WeakMap<SplatEffect | EffectSet, Error>;

/** An effect of one cloud that is not drawn, because of an error that is no argument's. */
interface LeftOut {
  readonly effect: SplatEffect;
  readonly error: Error;
}

/** The effects of one cloud that can be drawn, and the others. */
interface SoundEffects {
  readonly acting: readonly Pick<PlannedUse, 'use' | 'resources'>[];
  readonly leftOut: readonly LeftOut[];
  readonly effects: EffectSet;
}

/** What the effects of one cloud come to in one frame. */
export interface CloudEffects {
  /** Effects that the cloud is drawn with, in the order in which they act. */
  readonly uses: readonly PlannedUse[];
  readonly effects: EffectSet;
  readonly leftOut: readonly LeftOut[];
  /** Packed parameters of all effects, as shaders read them; of instances, one after another. */
  readonly parameters: Uint8Array;
  /** How far all effects together move splats, and how much they enlarge them. */
  readonly reach: SplatReach;
  /** Variance that is added to both screen axes of every splat, px². */
  readonly dilationPx2: number;
}

/** Everything that decides which effects a cloud is drawn with. */
interface EffectSource {
  /** Multiplies every splat's opacity, 0…1; default 1. */
  readonly opacity?: number;
  readonly effects?: readonly EffectUse[];
  /** Opacity and tint of each instance; undefined if all instances share the cloud's. */
  readonly instances?: { readonly opacities?: ArrayLike<number>; readonly tints?: ArrayLike<number> };
  /** Time at which a moving cloud is shown; default: its first. */
  readonly time?: number;
  /** Facts from the cloud's file, and its features; default: not trained with antialiasing, still. */
  readonly cloud?: {
    readonly facts: Pick<CloudFacts, 'isAntialiased'>;
    readonly features?: readonly { readonly effectAt?: (time: number | undefined) => EffectUse }[];
  };
}

/** An `EffectSource` in a frame. */
interface DrawnSource extends EffectSource {
  readonly cloud: NonNullable<EffectSource['cloud']> & BoundCloud;
}

/**
 * Returns the effects that a cloud is drawn with. First comes the motion of a moving cloud, then custom
 * effects in the given order, since they may move splats, then those of EFFECT_LIST in its order. Effects
 * that the cloud itself needs are added.
 *
 * @throws InvalidArgumentError if an effect other than `volumes` is used twice, or the opacity is out of range.
 */
export function usesOf(source: EffectSource): readonly EffectUse[] {
  const { effects: requested = [] } = source;
  if (!Array.isArray(requested) || [...requested].some((use) => !use?.effect))
    throw wrongArgument('effects', requested, 'a list of what effects return, such as [tint([1, 0, 0])]');
  const { opacity: factor = 1, time, cloud } = source;
  if (time !== undefined && !Number.isFinite(time))
    throw wrongArgument('time', time, 'a finite number, the time at which a moving cloud is shown');
  const uses = joinedUses(requested);
  // Host objects always have an opacity: if it is 1, a caller's effects may include that effect.
  if (factor !== 1) uses.push(opacity(factor));
  if (cloud?.facts.isAntialiased) turnOnAntialias(uses);
  const names = uses.map(({ effect }) => effect.name);
  const twice = names.find((name, i) => names.indexOf(name) !== i);
  if (twice !== undefined) {
    const message = `The effect ${twice} is used twice for one cloud; use it once, with all its options.`;
    throw new InvalidArgumentError('effects', message);
  }
  const { opacities, tints } = source.instances ?? {};
  if (opacities) turnOn(uses, opacity(1));
  if (tints) turnOn(uses, tint([1, 1, 1]));
  const acting = uses.filter(({ reason }) => reason !== null);
  const moving = cloud?.features?.find(({ effectAt }) => effectAt)?.effectAt?.(time);
  return [
    ...(moving ? [moving] : []),
    ...acting.toSorted((a, b) => placeInList(a.effect) - placeInList(b.effect)),
  ];
}

/** Joins uses of an effect that can be joined, each in the place of the first. */
function joinedUses(requested: readonly EffectUse[]): EffectUse[] {
  const uses: EffectUse[] = [];
  for (const use of requested) {
    const at = uses.findIndex(({ effect, joined }) => joined && effect === use.effect);
    if (at < 0) uses.push(use);
    else uses[at] = uses[at].joined!(use);
  }
  return uses;
}

/** Adds `neutral` unless `uses` has its effect, and turns the effect on: instances set its parameters. */
function turnOn(uses: EffectUse[], neutral: EffectUse): void {
  const at = uses.findIndex(({ effect }) => effect === neutral.effect);
  const use = { ...(uses[at] ?? neutral), reason: `its instances have a ${neutral.effect.name} each` };
  uses.splice(at < 0 ? uses.length : at, 1, use);
}

/** Antialiases as in training, unless `uses` says otherwise. */
function turnOnAntialias(uses: EffectUse[]): void {
  const at = uses.findIndex(({ effect }) => effect === antialias.effect);
  const isTold = at >= 0 && (uses[at].reason === null || dilationAskedBy(uses[at]) !== undefined);
  if (!isTold) uses.splice(at < 0 ? uses.length : at, 1, antialias({ dilationPx2: DILATION_PX2 }));
}

function dilationAskedBy({ options }: EffectUse): number | undefined {
  return (Object(options) as AntialiasOptions).dilationPx2;
}

/** Returns the variance that `uses` add to both screen axes of every splat, px². */
export function dilationOf(uses: readonly EffectUse[]): number {
  const use = uses.find(({ effect }) => effect === antialias.effect);
  return use ? (dilationAskedBy(use) ?? ANTIALIAS_DILATION_PX2) : DILATION_PX2;
}

/**
 * Returns how far all of `uses` together may move splats, in the cloud's units, and how much they
 * may enlarge them.
 *
 * @param modelMatrices cloud to world, of all places of the cloud.
 */
export function reachOf(uses: readonly EffectUse[], modelMatrices: readonly ArrayLike<number>[]): SplatReach {
  const inWorld = uses.reduce((sum, { reach }) => sum + (reach.displacementWorld ?? 0), 0);
  let unitsPerWorld = 0;
  if (inWorld > 0)
    for (const matrix of modelMatrices) {
      const toCloud = invert3(linearPart(matrix));
      // Clouds that their matrix flattens are not displaced.
      if (toCloud) unitsPerWorld = Math.max(unitsPerWorld, stretchBound(toCloud));
    }
  const blurs = uses.flatMap(({ reach }) => reach.blur ?? []);
  return {
    displacement: uses.reduce((sum, { reach }) => sum + reach.displacement, inWorld * unitsPerWorld),
    growth: uses.reduce((product, { reach }) => product * reach.growth, 1),
    ...(blurs.length > 0 && {
      blur: {
        atEye: blurs.reduce((sum, { atEye }) => sum + atEye, 0),
        perDepth: blurs.reduce((sum, { perDepth }) => sum + perDepth, 0),
      },
    }),
  };
}

/**
 * Returns what a cloud is drawn with.
 *
 * @param places matrices of its instances, cloud to world; null: it is drawn once, by `modelMatrix`.
 * @throws InvalidArgumentError naming the cloud, if its effects cannot be combined.
 */
export function cloudEffects(
  source: DrawnSource,
  faults: EffectFaults,
  places: readonly ArrayLike<number>[] | null,
  modelMatrix: ArrayLike<number>,
  placeBy: (modelMatrix: ArrayLike<number>) => EffectPlace,
): CloudEffects {
  const { acting, leftOut, effects } = soundEffects(source, faults);
  const drawn = acting.map(({ use }) => use);
  const uses = acting.map(({ use, resources }) => ({
    use,
    values: ownValues(use.valuesAt(placeBy(modelMatrix))),
    selectionVersion: use.selection?.version,
    resources,
  }));
  const { instances } = source;
  const parameters = packParameters(
    effects,
    places && instances
      ? places.map((matrix, i) => valuesOfInstance(uses, placeBy(matrix), instances, i))
      : [uses],
  );
  const reach = reachOf(drawn, places ?? [modelMatrix]);
  return { uses, effects, leftOut, parameters, reach, dilationPx2: dilationOf(drawn) };
}

/**
 * Checks the effects of a cloud that is not planned.
 *
 * @throws InvalidArgumentError
 */
export function checkEffects(source: DrawnSource): void {
  soundEffects(source, new WeakMap());
}

/** @throws InvalidArgumentError */
function soundEffects(source: DrawnSource, faults: EffectFaults): SoundEffects {
  const { cloud } = source;
  const asked = namedUsesOf(source);
  const leftOut: LeftOut[] = [];
  const sound = asked.flatMap((use) => {
    const { effect } = use;
    const resources = effect.resources?.on(use, asked, cloud) ?? NO_RESOURCES;
    const error = faults.get(effect) ?? effect.resources?.refusal(resources, cloud.device);
    if (!error) return { use, resources };
    leftOut.push({ effect, error });
    return [];
  });
  // Some sets cannot be drawn with, and nothing tells because of which effect. Motion is the first.
  const motion = cloud.timeRange ? sound.slice(0, 1) : [];
  for (const acting of [sound, motion, []]) {
    const effects = effectSetOf(acting.map(({ use }) => use));
    const error = faults.get(effects);
    if (!error) return { acting, leftOut, effects };
    leftOut.push(...acting.map(({ use: { effect } }) => ({ effect, error })));
  }
  throw new RangeError('A set without effects cannot have a fault.');
}

/** `usesOf`, with the cloud's name in errors. */
function namedUsesOf(source: DrawnSource): readonly EffectUse[] {
  try {
    return usesOf(source);
  } catch (error) {
    if (!(error instanceof InvalidArgumentError)) throw error;
    throw new InvalidArgumentError(error.argument, `${source.cloud.name}: ${error.message}`);
  }
}

/** Values of a cloud's effects for one of its instances, with its own opacity and tint. */
function valuesOfInstance(
  uses: readonly PlannedUse[],
  place: EffectPlace,
  { opacities, tints }: NonNullable<EffectSource['instances']>,
  i: number,
): Pick<PlannedUse, 'use' | 'values'>[] {
  return uses.map(({ use }) => {
    const values = use.valuesAt(place);
    if (opacities && use.effect === opacity.effect)
      return { use, values: { factor: (values!.factor as number) * opacities[i] } };
    if (tints && use.effect === tint.effect) {
      const color = Array.from(
        values!.color as ArrayLike<number>,
        (factor, at) => factor * tints[3 * i + at],
      );
      return { use, values: { color } };
    }
    return { use, values };
  });
}

/** Whether an effect shows a selection of splats. */
export function showsSelection({ selectionVersion }: PlannedUse): boolean {
  return selectionVersion !== undefined;
}

/** Copies values: callers may change their arrays later. */
function ownValues(values: GpuValues<GpuFields> | null): GpuValues<GpuFields> | null {
  if (!values) return null;
  const own = Object.entries(values).map(([name, value]) => [
    name,
    typeof value === 'number' ? value : Array.from(value),
  ]);
  return Object.fromEntries(own);
}
