import { isAccuracyTarget } from '../data/accuracy/accuracy-target.ts';
import { given } from '../data/given.ts';
import { callListener } from '../data/listeners.ts';
import { AUTOMATIC_FEATURES } from '../frame/ledger/automatic-features.ts';
import type { EffectEntry } from '../frame/ledger/ledger.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { antialias } from '../gpu/effects/antialias/antialias.ts';
import { checkMeasured } from './check-options.ts';
import type { MeasureProgress } from './measure-accuracy.ts';
import type { MeasuredEngine, MeasuredView } from './measured-engine.ts';
import { drawMeasured, withView } from './measured-frames.ts';
import { type TimeSpread, timeSpread } from './time-spread.ts';

/** Frame and repetitions of `measureEffects`. */
export interface MeasureEffectsOptions {
  /**
   * Pairs of counted frames per effect, with it and without, default 15; half as many again are
   * drawn and not counted. Fewer than 6 pairs give no 95 % interval: see `TimeSpread`.
   */
  readonly frames?: number;
  /** Names of the effects to measure; default all. Effects that are off or unknown have no cost. */
  readonly names?: readonly string[];
  /** Ends the measurement: it rejects with the signal's reason and frees its memory. */
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: MeasureProgress) => void;
}

/** Cost of one effect in a frame. */
export interface EffectCost {
  /** The effect's name in the ledger. */
  readonly name: string;
  /**
   * Milliseconds of a whole frame with the effect minus milliseconds without it; below 0 if the
   * effect saves time. If `low` is below and `high` above 0, there is no measurable difference.
   */
  readonly costMs: Pick<TimeSpread, 'median' | 'low' | 'high'>;
}

const DEFAULT_FRAMES = 15;

/**
 * Measures the cost of each effect in `frame` by drawing the frame with the effect and without, A
 * B, B A, A B, …, in one view of its own; other work of the page goes on between frames. Where
 * buffers and textures lie in memory can change the time of a frame by more than an effect does, so
 * both kinds use the same ones and only other shaders. The first frame after each change is not
 * counted: its parameters may be in a new buffer, and caches hold data that the other kind of frame
 * has read.
 *
 * Measures, in the ledger's order, the requested effects, and the automatic features that a frame
 * can do without (`harmonics`, `isotropic`). If `frame` has a target, the engine's settings are
 * measured. An effect that moves splats may lengthen sort keys, which takes new buffers: only then
 * do the two kinds of frames not share theirs.
 *
 * @throws InvalidArgumentError, GpuLimitError, DestroyedError; the reason of `signal`.
 * @example
 * const clouds = [{ cloud, effects: [fog({ color: [1, 1, 1], near: 2, far: 20 })] }];
 * const costs = await measureEffects(engine, { camera, clouds, widthPx, heightPx });
 * for (const { name, costMs } of costs) console.log(`${name}: ${costMs.median} ms`);
 */
export async function measureEffects(
  engine: MeasuredEngine,
  frame: Pick<FrameRequest, 'camera' | 'clouds' | 'widthPx' | 'heightPx' | 'accuracy' | 'sortBy' | 'detail'>,
  options: MeasureEffectsOptions = {},
): Promise<EffectCost[]> {
  const { frames = DEFAULT_FRAMES, names, signal, onProgress } = given(options);
  checkMeasured(engine, frame, { frames });
  const { accuracy = engine.accuracy } = frame;
  const settings = isAccuracyTarget(accuracy) ? engine.accuracy : accuracy;
  const request: FrameRequest = { ...frame, accuracy: settings, force: true };
  return withView(engine, async (view) => {
    signal?.throwIfAborted();
    await drawMeasured(engine, view, request);
    const comparisons = view
      .effects()
      .filter(({ name }) => names?.includes(name) ?? true)
      .flatMap((entry) => comparisonFor(entry, request) ?? []);
    const frameTimer = new FrameTimer(engine, view);
    const costs: EffectCost[] = [];
    for (const [index, comparison] of comparisons.entries()) {
      const { entry } = comparison;
      // Not counted: it makes shaders and buffers.
      await frameTimer.draw(comparison.without);
      const differencesMs: number[] = [];
      for (let pair = 0; pair < frames; pair++) {
        signal?.throwIfAborted();
        const done = index * frames + pair;
        const total = comparisons.length * frames;
        callListener(onProgress, { done, total, label: `Timing ${entry.label}` });
        // Alternate the order, so that drift slows first and second of a pair equally often.
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

/** Frames that should all take the same time. */
interface FrameKind {
  readonly request: FrameRequest;
  readonly mayBeIsotropic: boolean;
}

/** The two kinds of frames that one effect is measured with. */
interface Comparison {
  readonly entry: EffectEntry;
  readonly with: FrameKind;
  readonly without: FrameKind;
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

  /** Returns the milliseconds of a frame that follows another of its kind. */
  async timeMs(kind: FrameKind): Promise<number> {
    if (kind !== this.#last) await this.draw(kind);
    return this.draw(kind);
  }

  /** Returns the milliseconds of the next frame of this kind, after any other. */
  async draw(kind: FrameKind): Promise<number> {
    this.#view.mayBeIsotropic = kind.mayBeIsotropic;
    this.#last = kind;
    const { timing } = await drawMeasured(this.#engine, this.#view, kind.request);
    return timing.totalMs;
  }
}

/** Returns null for effects that a frame cannot do without, and for effects that are off. */
function comparisonFor(entry: EffectEntry, request: FrameRequest): Comparison | null {
  const { name, isOn } = entry;
  const whole: FrameKind = { request, mayBeIsotropic: true };
  const comparedWith = (without: FrameKind): Comparison => ({ entry, with: whole, without });
  if (!isOn) return null;
  if (name === 'levels') return comparedWith({ ...whole, request: { ...request, detail: 'full' } });
  if (name === 'isotropic') return comparedWith({ ...whole, mayBeIsotropic: false });
  if (name === 'harmonics') {
    const clouds = request.clouds.map((instance) => ({ ...instance, shDegree: 0 as const }));
    return comparedWith({ ...whole, request: { ...request, clouds } });
  }
  if (AUTOMATIC_FEATURES.some((feature) => feature.name === name)) return null;
  const clouds = request.clouds.map(({ opacity, effects = [], instances, ...instance }) => {
    const others = effects.filter(({ effect }) => effect.name !== name);
    return {
      ...instance,
      opacity: name === 'opacity' ? undefined : opacity,
      instances: instances && {
        ...instances,
        ...(name === 'opacity' && { opacities: undefined }),
        ...(name === 'tint' && { tints: undefined }),
      },
      // Clouds may need it on their own.
      effects: name === 'antialias' ? [...others, antialias(false)] : others,
    };
  });
  return comparedWith({ ...whole, request: { ...request, clouds } });
}
