import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { frameStages } from '../frame/frame-passes.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { FrameShape } from '../frame/plan/frame-shape.ts';
import type { Pipelines } from '../gpu/pipelines.ts';

/**
 * Reason of a wait. `shaders`: shaders or clouds are not ready. `memory`: the frame also lacked
 * memory. `parts`: the last frame is submitted in parts. `held`: the planes of a cloud are about to
 * change.
 */
export type WaitReason = 'shaders' | 'memory' | 'parts' | 'held';

/** Clouds whose levels a frame needs but which have none yet. */
export function lackingLevels({ clouds }: FramePlan): readonly SplatCloud[] {
  const lacking = clouds.filter(({ inFull, instance }) => inFull === null && !instance.cloud.levels);
  return lacking.map(({ instance }) => instance.cloud);
}

interface Wait {
  /** The newest request. */
  request: FrameRequest;
  readonly reason: WaitReason;
  /** Settles when the request is drawn. */
  drawn: Promise<void>;
}

/** Shapes with compiled shaders, and the waiting request; a newer request replaces it. */
export class FrameWait {
  readonly #pipelines: Pick<Pipelines, 'areReady' | 'prepare'>;
  readonly #retry: (request: FrameRequest | null) => Promise<void> | null;
  readonly #canDrawWithout: (error: unknown, plan: FramePlan) => boolean;
  /** Shapes whose shaders have been compiled. */
  readonly #ready = new WeakSet<FrameShape>();
  #wait: Wait | null = null;

  /**
   * @param retry called at the end of a wait, with the newest request; with null if another request
   *   was drawn meanwhile. Returns a promise that settles when the request is drawn.
   * @param canDrawWithout called with the error of a shader that the frame needs. Returns whether the next
   *   plan of the request does without that shader.
   */
  constructor(
    pipelines: Pick<Pipelines, 'areReady' | 'prepare'>,
    retry: (request: FrameRequest | null) => Promise<void> | null,
    canDrawWithout: (error: unknown, plan: FramePlan) => boolean,
  ) {
    this.#pipelines = pipelines;
    this.#retry = retry;
    this.#canDrawWithout = canDrawWithout;
  }

  /** Reason why the newest request waits; null if it does not. */
  get reason(): WaitReason | null {
    return this.#wait?.reason ?? null;
  }

  isReady(shape: FrameShape): boolean {
    if (this.#ready.has(shape)) return true;
    const isReady = this.#pipelines.areReady(frameStages(shape));
    if (isReady) this.#ready.add(shape);
    return isReady;
  }

  /**
   * Whether the shaders of a shape are compiled. Missing shaders start to compile for later frames.
   */
  isReadyOrCompiling(shape: FrameShape): boolean {
    const isReady = this.isReady(shape);
    // The frame that needs a shader waits for it, and reports its error.
    if (!isReady) this.#pipelines.prepare(frameStages(shape)).catch(() => {});
    return isReady;
  }

  /**
   * Resolves when the shaders of `plan` are compiled, its clouds are uploaded, and their levels
   * made.
   */
  async whenReady(plan: FramePlan): Promise<void> {
    const uploads = plan.request.clouds.map(({ cloud }) => cloud.uploaded);
    const compiled = this.#pipelines.prepare(frameStages(plan.shape)).catch((error: unknown) => {
      if (!this.#canDrawWithout(error, plan)) throw error;
    });
    await Promise.all([compiled, ...uploads]);
    // If levels fail, the cloud has the error and is drawn in full.
    await Promise.allSettled(lackingLevels(plan).map((cloud) => cloud.makeLevels()));
  }

  /**
   * Makes a request wait until `until` resolves. It replaces a request that waits for the same
   * reason; a request that waits for another reason is dropped.
   *
   * @returns a promise that settles when the request, or a newer one, is drawn.
   */
  begin(request: FrameRequest, reason: WaitReason, until: () => Promise<unknown>): Promise<void> {
    if (this.#wait?.reason === reason) {
      this.#wait.request = request;
      return this.#wait.drawn;
    }
    const wait: Wait = { request, reason, drawn: Promise.resolve() };
    this.#wait = wait;
    wait.drawn = this.#drawAfter(until(), wait);
    // Callers that do not await the frame get errors of shaders by `canDrawWithout`, and those of a cloud from
    // the promise that they have of it.
    wait.drawn.catch(() => {});
    return wait.drawn;
  }

  /** Call when the newest request no longer waits. */
  end(): void {
    this.#wait = null;
  }

  async #drawAfter(ready: Promise<unknown>, wait: Wait): Promise<void> {
    let isWaiting = false;
    try {
      await ready;
    } finally {
      isWaiting = this.#wait === wait;
      if (isWaiting) this.#wait = null;
    }
    await this.#retry(isWaiting ? wait.request : null);
  }
}
