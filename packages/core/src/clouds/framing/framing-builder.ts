import { frameSample } from '../../data/framing/frame-sample.ts';
import type { FramingWishes, SceneFraming } from '../../data/framing/scene-framing.ts';
import { nextTask } from '../../data/turns.ts';
import type { GeometryBuilder, GeometryBuilders } from '../geometry-builder.ts';
import type { SampledSplats } from './sampled-splats.ts';
import { decodeSamples } from './splat-decoder.ts';

export interface FramingPlan {
  readonly wishes: FramingWishes;
  /** Splats that each sample stands for, in the mean. */
  readonly weight: number;
}

export interface FramingResult {
  readonly framing: SceneFraming | null;
}

/** Frames a scene; its pieces are the samples of its clouds. */
export class FramingBuilder implements GeometryBuilder<FramingResult, SampledSplats> {
  readonly #plan: FramingPlan;
  readonly #signal: AbortSignal | undefined;
  readonly #parts: SampledSplats[] = [];

  constructor(plan: FramingPlan, signal?: AbortSignal) {
    this.#plan = plan;
    this.#signal = signal;
  }

  async add(part: SampledSplats): Promise<void> {
    this.#parts.push(part);
  }

  /** @throws the signal's reason. */
  async finish(): Promise<FramingResult> {
    const { wishes, weight } = this.#plan;
    const sample = decodeSamples(this.#parts, weight);
    // A thread that has other work gets to it in between.
    await nextTask();
    this.#signal?.throwIfAborted();
    return { framing: frameSample(sample, wishes) };
  }
}

/** For the worker. */
export const FRAMING_BUILDERS: GeometryBuilders = {
  framing: (plan: FramingPlan) => new FramingBuilder(plan),
};
