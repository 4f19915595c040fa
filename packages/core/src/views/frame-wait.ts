import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { frameStages } from '../frame/frame.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { FrameShape } from '../frame/frame-shape.ts';
import type { Pipelines } from '../gpu/pipelines.ts';

/**
 * Reason of a wait: shaders and clouds; memory besides; the last frame, submitted in parts; a cloud
 * whose planes are about to change.
 */
export type WaitReason = 'shaders' | 'memory' | 'parts' | 'held';

/** Clouds whose levels a frame needs, and which are still to be made. */
export function lackingLevels({ clouds }: FramePlan): readonly SplatCloud[] {
  const lacking = clouds.filter(({ inFull, instance }) => inFull === null && !instance.cloud.levels);
  return lacking.map(({ instance }) => instance.cloud);
}

interface Wait {
  /** The newest request. */
  request: FrameRequest;
  readonly reason: WaitReason;
  /** Settles when the request has been drawn. */
  drawn: Promise<void>;
}

/** Shapes that have their shaders, and the request that waits: the newest replaces earlier ones. */
export class FrameWait {
  readonly #pipelines: Pick<Pipelines, 'areReady' | 'prepare'>;
  readonly #retry: (request: FrameRequest | null) => Promise<void> | null;
  /** Shapes whose shaders have been compiled. */
  readonly #ready = new WeakSet<FrameShape>();
  #wait: Wait | null = null;

  /**
   * @param retry called when a wait is over, with the newest request; with null if another was
   *   drawn meanwhile. Returns a promise that settles when the request has been drawn.
   */
  constructor(
    pipelines: Pick<Pipelines, 'areReady' | 'prepare'>,
    retry: (request: FrameRequest | null) => Promise<void> | null,
  ) {
    this.#pipelines = pipelines;
    this.#retry = retry;
  }

  /** Reason why the newest request waits; null if it does not wait. */
  get reason(): WaitReason | null {
    return this.#wait?.reason ?? null;
  }

  isReady(shape: FrameShape): boolean {
    if (this.#ready.has(shape)) return true;
    const isReady = this.#pipelines.areReady(frameStages(shape));
    if (isReady) this.#ready.add(shape);
    return isReady;
  }

  /** Whether the shaders of a shape are compiled; compiles missing ones for frames to come. */
  isReadyOrCompiling(shape: FrameShape): boolean {
    const isReady = this.isReady(shape);
    // A frame that needs one that does not compile tells.
    if (!isReady) this.#pipelines.prepare(frameStages(shape)).catch(() => {});
    return isReady;
  }

  /** Resolves when the shaders of `plan` are compiled, and its clouds uploaded and in levels. */
  async whenReady(plan: FramePlan): Promise<void> {
    const uploads = plan.request.clouds.map(({ cloud }) => cloud.uploaded);
    await Promise.all([this.#pipelines.prepare(frameStages(plan.shape)), ...uploads]);
    // Where they cannot be made, the cloud tells, and is drawn in full.
    await Promise.allSettled(lackingLevels(plan).map((cloud) => cloud.makeLevels()));
  }

  /**
   * Lets a request wait until `until` resolves. If one waits for the same reason, this takes its
   * place instead; one that waits for another reason is left out.
   *
   * @returns a promise that settles when the request, or a newer one in its place, has been drawn.
   */
  begin(request: FrameRequest, reason: WaitReason, until: () => Promise<unknown>): Promise<void> {
    if (this.#wait?.reason === reason) {
      this.#wait.request = request;
      return this.#wait.drawn;
    }
    const wait: Wait = { request, reason, drawn: Promise.resolve() };
    this.#wait = wait;
    wait.drawn = this.#drawAfter(until(), wait);
    // The device itself reports a shader that does not compile; callers that do not await the frame
    // get no second error.
    wait.drawn.catch(() => {});
    return wait.drawn;
  }

  /** Call when the newest request waits no longer. */
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
