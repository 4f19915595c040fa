import { isAccuracyWish } from '../accuracy/accuracy-wish.ts';
import type { Camera } from '../camera/camera.ts';
import { antialias } from '../effects/antialias.ts';
import { InvalidArgumentError } from '../errors.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { OmittableEffect } from '../frame/frame-shape.ts';
import { FOUND_EFFECTS } from '../ledger/found-effects.ts';
import type { EffectEntry } from '../ledger/ledger.ts';
import { multiply4 } from '../math/mat4.ts';
import type { MeasureProgress } from './measure-accuracy.ts';
import type { MeasuredEngine, MeasuredView } from './measured-engine.ts';
import { drawMeasured, withView } from './measured-frames.ts';
import { type TimeSpread, timeSpread } from './time-spread.ts';

export interface MeasureEffectsOptions {
  /**
   * Pairs of counted frames per effect, with it and without, default 15; half as many again are drawn and not counted. Under
   * 6 there is no interval of 95 %: see `TimeSpread`.
   */
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
 * Measures what each effect costs in `frame` by drawing it with the effect and without, A B, B A, A B, …, in one view of its
 * own; other work of the page goes on between frames. Where buffers and textures lie can change the time of a frame by more
 * than an effect does: both are drawn in the same ones, only by other shaders. The first frame after each change is not
 * counted: its parameters may be in a new buffer, and caches hold what the other kind of frame has read.
 *
 * In the order of the ledger: the effects that callers ask for and of those that are found the ones that a picture can do
 * without, `harmonics`, `isotropic` and `faint-splats`; and `kept-colors`, whether on now or not, by a camera that turns in
 * place. Frames without it evaluate every colour and leave what is kept alone; the first with it, which is not counted, fills
 * it, and the counted one behind that finds all colours there. What is on because of a wish is measured with the settings that
 * the engine has. An effect that moves splats may make sort keys longer, for which buffers are made anew: that is the one case
 * in which the two are not drawn in the same.
 *
 * @throws InvalidArgumentError, GpuLimitError, DestroyedError; the reason of `signal`.
 */
export async function measureEffects(
  engine: MeasuredEngine,
  frame: Pick<FrameRequest, 'camera' | 'clouds' | 'widthPx' | 'heightPx' | 'accuracy'>,
  { frames = DEFAULT_FRAMES, signal, onProgress }: MeasureEffectsOptions = {},
): Promise<EffectCost[]> {
  checkOptions(frame, frames);
  const { accuracy = engine.accuracy } = frame;
  const settings = isAccuracyWish(accuracy) ? engine.accuracy : accuracy;
  const picture: FrameRequest = { ...frame, accuracy: settings, force: true };
  return withView(engine, async (view) => {
    signal?.throwIfAborted();
    await drawMeasured(engine, view, picture);
    const comparisons = view.effects().flatMap((entry) => comparisonFor(entry, picture) ?? []);
    const frameTimer = new FrameTimer(engine, view);
    const costs: EffectCost[] = [];
    for (const [index, comparison] of comparisons.entries()) {
      const { entry } = comparison;
      if (!(await warmUp(frameTimer, view, comparison))) continue;
      const differencesMs: number[] = [];
      for (let pair = 0; pair < frames; pair++) {
        signal?.throwIfAborted();
        const done = index * frames + pair;
        onProgress?.({ done, total: comparisons.length * frames, label: `Timing ${entry.label}` });
        // What drifts makes as many of the first as of the second of a pair slower.
        let withoutMs = pair % 2 === 0 ? null : await frameTimer.timeMs(comparison.without);
        const withMs = await frameTimer.timeMs(comparison.with);
        withoutMs ??= await frameTimer.timeMs(comparison.without);
        differencesMs.push(withMs - withoutMs);
      }
      const { median, low, high } = timeSpread(differencesMs);
      costs.push({ name: entry.name, costMs: { median, low, high } });
    }
    return costs;
  });
}

/** Frames that differ in nothing that takes time. */
interface FrameKind {
  /** What to draw next. */
  readonly next: () => FrameRequest;
  readonly omitted: readonly OmittableEffect[];
}

/** How one effect is measured. */
interface Comparison {
  readonly entry: EffectEntry;
  readonly with: FrameKind;
  readonly without: FrameKind;
  /** Whether the effect comes by itself, with the second frame or a later one. */
  readonly comesLater: boolean;
}

/** Draws frames of several kinds in one view. */
class FrameTimer {
  readonly #engine: MeasuredEngine;
  readonly #view: MeasuredView;
  #last: FrameKind | null = null;

  constructor(engine: MeasuredEngine, view: MeasuredView) {
    this.#engine = engine;
    this.#view = view;
  }

  /** @returns milliseconds of a frame that follows another one of its kind. */
  async timeMs(kind: FrameKind): Promise<number> {
    if (kind !== this.#last) await this.draw(kind);
    return this.draw(kind);
  }

  /** @returns milliseconds of the next frame of this kind, whatever was drawn before. */
  async draw(kind: FrameKind): Promise<number> {
    this.#view.omitEffects(kind.omitted);
    this.#last = kind;
    const { totalMs } = await drawMeasured(this.#engine, this.#view, kind.next());
    return totalMs;
  }
}

/** Null for what a picture cannot do without, and what it does not have. */
function comparisonFor(entry: EffectEntry, picture: FrameRequest): Comparison | null {
  const { name, isOn } = entry;
  const whole: FrameKind = { next: () => picture, omitted: [] };
  const comparedWith = (without: FrameKind): Comparison => ({
    entry,
    with: whole,
    without,
    comesLater: false,
  });
  if (name === 'kept-colors') {
    const turned = turning(picture);
    // Frames that are forced keep no colours.
    const keeping: FrameKind = { next: () => ({ ...turned(), force: false }), omitted: [] };
    return { entry, with: keeping, without: { next: turned, omitted: [] }, comesLater: true };
  }
  if (!isOn) return null;
  if (name === 'isotropic' || name === 'faint-splats') return comparedWith({ ...whole, omitted: [name] });
  if (name === 'harmonics') {
    const clouds = picture.clouds.map((instance) => ({ ...instance, shDegree: 0 as const }));
    return comparedWith({ ...whole, next: () => ({ ...picture, clouds }) });
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
  return comparedWith({ ...whole, next: () => ({ ...picture, clouds }) });
}

/** Frames that are not counted: they make shaders and buffers. Answers whether the effect takes part then. */
async function warmUp(frameTimer: FrameTimer, view: MeasuredView, comparison: Comparison): Promise<boolean> {
  await frameTimer.draw(comparison.without);
  if (!comparison.comesLater) return true;
  for (let attempt = 0; attempt < MOST_ATTEMPTS; attempt++) {
    await frameTimer.draw(comparison.with);
    if (view.effects().some(({ name, isOn }) => name === comparison.entry.name && isOn)) return true;
  }
  return false;
}

/** Frames in which shaders are compiled, or never. */
const MOST_ATTEMPTS = 30;
/** Far less than a pixel across any picture. */
const TURN_RADIANS = 1e-6;

/** The picture from one place, the camera each time turned a little further about its line of sight. */
function turning(picture: FrameRequest): () => FrameRequest {
  let turns = 0;
  return () => {
    const angle = ++turns * TURN_RADIANS;
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const turn = Float64Array.of(cos, sin, 0, 0, -sin, cos, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
    const camera: Camera = { ...picture.camera, viewMatrix: multiply4(turn, picture.camera.viewMatrix) };
    return { ...picture, camera };
  };
}

function checkOptions(
  { widthPx, heightPx }: Pick<FrameRequest, 'widthPx' | 'heightPx'>,
  frames: number,
): void {
  for (const [name, value] of Object.entries({ widthPx, heightPx, frames })) {
    if (!(Number.isInteger(value) && value >= 1))
      throw new InvalidArgumentError(name, `${name} is ${value}; it must be a whole number from 1 on.`);
  }
}
