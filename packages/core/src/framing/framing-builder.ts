import type { GeometryBuilder, GeometryBuilders } from '../clouds/geometry-builder.ts';
import { nextTask } from '../data/turns.ts';
import { frameSample } from './frame-sample.ts';
import type { SampledSplats } from './samples.ts';
import type { FramingWishes, SceneFraming } from './scene-framing.ts';
import { decodeSamples } from './splat-decoder.ts';

export interface FramingPlan {
  readonly wishes: FramingWishes;
  /** Mean number of splats per sample. */
  readonly weight: number;
}

export interface FramingResult {
  readonly framing: SceneFraming | null;
}

/** Computes the framing of a scene from samples of its clouds, one piece per cloud. */
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
    // Yields, in case this thread has other work.
    await nextTask();
    this.#signal?.throwIfAborted();
    return { framing: frameSample(sample, wishes) };
  }
}

export const FRAMING_BUILDERS: GeometryBuilders = {
  framing: (plan: FramingPlan) => new FramingBuilder(plan),
};
