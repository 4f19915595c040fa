import { ANTIALIAS_DILATION_PX2, DILATION_PX2 } from '../../data/accuracy/accuracy.ts';
import type { SplatReach } from '../../data/camera/frustum.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { wrongArgument } from '../../data/given.ts';
import { invert3, linearPart, stretchBound } from '../../data/math/mat4.ts';
import type { CloudFacts } from '../../data/packing/cloud-facts.ts';
import { type AntialiasOptions, antialias } from './antialias/antialias.ts';
import type { EffectUse } from './effect.ts';
import { placeInList } from './effect-list.ts';
import { opacity } from './opacity/opacity.ts';
import { tint } from './tint/tint.ts';

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
