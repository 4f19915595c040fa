import { isAccuracyWish } from '../accuracy-wish.ts';
import type { Camera } from '../camera.ts';
import { antialias } from '../effects/antialias.ts';
import { FOUND_EFFECTS } from '../effects/found-effects.ts';
import type { EffectEntry } from '../effects/ledger.ts';
import type { SplatEngine } from '../engine.ts';
import { InvalidArgumentError } from '../errors.ts';
import type { OmittableEffect } from '../frame-shape.ts';
import { multiply4 } from '../math/mat4.ts';
import type { ViewFrame } from '../scene/view-frame.ts';
import type { SplatView } from '../view.ts';
import type { MeasureProgress } from './measure-accuracy.ts';
import { drawMeasured, withView } from './measured-frames.ts';
import { type TimeSpread, timeSpread } from './time-spread.ts';

export interface MeasureEffectsOptions {
  /** Pairs of frames per effect, with it and without, default 15. Under 6 there is no interval of 95 %: see `TimeSpread`. */
  readonly frames?: number;
  /** Ends the measurement: it rejects with the signal's reason and frees what it holds. */
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: MeasureProgress) => void;
}

/** What one effect costs in a picture. */
export interface EffectCost {
  /** As in the ledger. */
  readonly name: string;
  /**
   * A frame with the effect less one without it, milliseconds of the whole frame; below 0 where it saves more than it
   * takes. Where `low` and `high` are on either side of 0 the two cannot be told apart.
   */
  readonly costMs: Pick<TimeSpread, 'median' | 'low' | 'high'>;
}

const DEFAULT_FRAMES = 15;

/**
 * Measures what each effect costs in `frame` by drawing it with the effect and without, A B, B A, A B, …, in two views of
 * its own; other work of the page goes on between frames. In the order of the ledger: the effects that callers ask for and
 * of those that are found the ones that a picture can do without, `harmonics`, `isotropic` and `faint-splats`; and
 * `kept-colors`, whether on now or not, by a camera that turns in place. What is on because of a wish is measured with the
 * settings that the engine has.
 *
 * @throws InvalidArgumentError, GpuLimitError, DestroyedError; the reason of `signal`.
 */
export async function measureEffects(
  engine: SplatEngine,
  frame: Pick<ViewFrame, 'camera' | 'clouds' | 'widthPx' | 'heightPx' | 'accuracy'>,
  { frames = DEFAULT_FRAMES, signal, onProgress }: MeasureEffectsOptions = {},
): Promise<EffectCost[]> {
  checkOptions(frame, frames);
  const { accuracy = engine.accuracy } = frame;
  const settings = isAccuracyWish(accuracy) ? engine.accuracy : accuracy;
  const picture: ViewFrame = { ...frame, accuracy: settings, force: true };
  return withView(engine, (whole) =>
    withView(engine, async (lacking) => {
      signal?.throwIfAborted();
      await drawMeasured(engine, whole, picture);
      const comparisons = whole.effects().flatMap((entry) => comparisonFor(entry, picture) ?? []);
      const costs: EffectCost[] = [];
      for (const [index, comparison] of comparisons.entries()) {
        const { entry } = comparison;
        lacking.omitEffects(comparison.omitted);
        if (!(await warmUp(engine, whole, lacking, comparison))) continue;
        const differencesMs: number[] = [];
        for (let pair = 0; pair < frames; pair++) {
          signal?.throwIfAborted();
          const done = index * frames + pair;
          onProgress?.({ done, total: comparisons.length * frames, label: `Timing ${entry.label}` });
          const timeOf = async (view: SplatView, drawn: ViewFrame) =>
            (await drawMeasured(engine, view, drawn)).totalMs;
          // What drifts makes as many of the first as of the second of a pair slower.
          let withoutMs = pair % 2 === 0 ? null : await timeOf(lacking, comparison.without());
          const withMs = await timeOf(whole, comparison.with());
          withoutMs ??= await timeOf(lacking, comparison.without());
          differencesMs.push(withMs - withoutMs);
        }
        const { median, low, high } = timeSpread(differencesMs);
        costs.push({ name: entry.name, costMs: { median, low, high } });
      }
      return costs;
    }),
  );
}

/** How one effect is measured: what to draw next with it, and without. */
interface Comparison {
  readonly entry: EffectEntry;
  readonly with: () => ViewFrame;
  readonly without: () => ViewFrame;
  readonly omitted: readonly OmittableEffect[];
  /** Whether the effect comes by itself, with the second frame or a later one. */
  readonly comesLater: boolean;
}

/** Null for what a picture cannot do without, and what it does not have. */
function comparisonFor(entry: EffectEntry, picture: ViewFrame): Comparison | null {
  const { name, isOn } = entry;
  const still = { entry, with: () => picture, without: () => picture, omitted: [], comesLater: false };
  if (name === 'kept-colors') {
    const turned = turning(picture);
    return { ...still, with: () => ({ ...turned(), force: false }), without: turned, comesLater: true };
  }
  if (!isOn) return null;
  if (name === 'isotropic' || name === 'faint-splats') return { ...still, omitted: [name] };
  if (name === 'harmonics') {
    const clouds = picture.clouds.map((instance) => ({ ...instance, shDegree: 0 as const }));
    return { ...still, without: () => ({ ...picture, clouds }) };
  }
  if (FOUND_EFFECTS.some((found) => found.name === name)) return null;
  const clouds = picture.clouds.map(({ opacity, effects = [], ...instance }) => {
    const others = effects.filter(({ effect }) => effect.name !== name);
    return {
      ...instance,
      opacity: name === 'opacity' ? undefined : opacity,
      // Clouds may call for it by themselves.
      effects: name === 'antialias' ? [...others, antialias(false)] : others,
    };
  });
  return { ...still, without: () => ({ ...picture, clouds }) };
}

/** Frames that are not counted: they make shaders and buffers. Answers whether the effect takes part then. */
async function warmUp(
  engine: SplatEngine,
  whole: SplatView,
  lacking: SplatView,
  comparison: Comparison,
): Promise<boolean> {
  await drawMeasured(engine, lacking, comparison.without());
  if (!comparison.comesLater) return true;
  for (let attempt = 0; attempt < MOST_ATTEMPTS; attempt++) {
    await drawMeasured(engine, whole, comparison.with());
    if (whole.effects().some(({ name, isOn }) => name === comparison.entry.name && isOn)) return true;
  }
  return false;
}

/** Frames in which shaders are compiled, or never. */
const MOST_ATTEMPTS = 30;
/** Far less than a pixel across any picture. */
const TURN_RADIANS = 1e-6;

/** The picture from one place, the camera each time turned a little further about its line of sight. */
function turning(picture: ViewFrame): () => ViewFrame {
  let turns = 0;
  return () => {
    const angle = ++turns * TURN_RADIANS;
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const turn = Float64Array.of(cos, sin, 0, 0, -sin, cos, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
    const camera: Camera = { ...picture.camera, viewMatrix: multiply4(turn, picture.camera.viewMatrix) };
    return { ...picture, camera };
  };
}

function checkOptions({ widthPx, heightPx }: Pick<ViewFrame, 'widthPx' | 'heightPx'>, frames: number): void {
  for (const [name, value] of Object.entries({ widthPx, heightPx, frames })) {
    if (!(Number.isInteger(value) && value >= 1))
      throw new InvalidArgumentError(name, `${name} is ${value}; it must be a whole number from 1 on.`);
  }
}
