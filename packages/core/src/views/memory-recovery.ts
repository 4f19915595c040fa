import type { GpuLimitError } from '../data/errors.ts';
import { fetched } from '../data/errors.ts';
import type { FrameParts } from '../frame/frame.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { RasterizerChoice } from './rasterizer-choice.ts';

type HeldParts = Pick<FrameParts, 'isDestroyed'>;

/** Actions of a view whose frame lacked memory. */
export interface RecoveringView {
  /** The buffers and textures of the view's frames; replaced when the view starts over. */
  parts(): HeldParts;
  /** Frees the parts and clears the last frame. */
  startOver(): void;
  /** Uses quads for frames of this load, because tiles lacked memory. */
  rejectTiles: RasterizerChoice['rejectTiles'];
  /** Draws a sound frame again, unless another was drawn since. Resolves when it is drawn. */
  restore(sound: FramePlan): Promise<void>;
  /**
   * Draws the successor of a failed frame: the waiting request or, if `again` is still the newest,
   * `again`.
   *
   * @returns a promise that settles when the successor is drawn; null if there is none.
   */
  drawSuccessor(again: FramePlan | null): Promise<void> | null;
}

/** A frame that lacked memory. */
interface Lack {
  readonly sizes: readonly number[];
  /** Bytes that the view would hold with that frame. */
  readonly bytes: number;
  readonly error: Error;
  /** Time of the last probe for memory. */
  probedMs: number;
}

const ADVICE = 'Draw a smaller image, or with a coarser accuracy or by quads, or load fewer splats.';

/** Least time between two probes for memory, ms, because a page may draw sixty times a second. */
const PROBE_PAUSE_MS = 250;

/**
 * Recovers from frames that lack memory, which the device reports later. Frees the frame's memory,
 * draws the last sound frame again, and throws the error once. Before a frame as large is drawn, it
 * probes for memory.
 */
export class MemoryRecovery {
  /** Error of the last frame; null once a caller has received it or another frame is drawn. */
  error: Error | null = null;
  readonly #memory: GpuMemory;
  readonly #view: RecoveringView;
  /**
   * The last frame whose memory was confirmed, and the one before, because dividing a frame takes
   * memory too.
   */
  #sound: FramePlan | null = null;
  #soundBefore: FramePlan | null = null;
  /** Identifies the newest running check; null if none runs. */
  #check: object | null = null;
  /** The frame that lacked memory; null once a frame as large fits. */
  #lack: Lack | null = null;

  /** @param memory all memory that the view holds. */
  constructor(memory: GpuMemory, view: RecoveringView) {
    this.#memory = memory;
    this.#view = view;
  }

  /** Whether the device has not yet confirmed the memory of the last frames. */
  get isChecking(): boolean {
    return this.#check !== null;
  }

  /** Whether a probe for the lacking memory is due. */
  get isProbeDue(): boolean {
    return this.#lack !== null && performance.now() - this.#lack.probedMs > PROBE_PAUSE_MS;
  }

  /** Whether `plan` needs at least as much memory as the frame that lacked it. */
  lacksRoomFor(plan: FramePlan): boolean {
    if (!this.#lack) return false;
    const { sizes } = this.#lack;
    return sizesOf(plan).every((size, i) => size >= sizes[i]);
  }

  /** Probes for memory. @throws the error of the frame that lacked it, if it is still lacking. */
  async findRoom(): Promise<void> {
    const lack = this.#lack;
    if (!lack) return;
    lack.probedMs = performance.now();
    // Fetched on demand, because few pages ever lack memory.
    const { probeMemory } = await fetched('memory probe', import('../gpu/probe-memory.ts'));
    const isThere = await probeMemory(this.#memory, lack.bytes - this.#memory.report().totalBytes);
    if (!isThere) throw lack.error;
    this.#lack = null;
  }

  /** Clears the sound frames; their buffers have been freed. */
  forget(): void {
    this.#sound = this.#soundBefore = null;
    this.#check = null;
  }

  /**
   * Runs `work`, which allocates, records and submits a frame. If the device later reports that
   * memory was lacking, the last sound frame is drawn again.
   *
   * @returns a promise that settles when the device has confirmed the memory, and rejects if the
   *   frame was void and has no successor; null if the frame allocated nothing new.
   * @throws GpuLimitError if device limits or the engine's memory budget do not allow the frame;
   *   the last one stays, or is drawn again.
   */
  draw(plan: FramePlan, work: () => void): Promise<void> | null {
    const parts = this.#view.parts();
    let checked: Promise<void> | null;
    try {
      // While a check runs, a frame in the checked memory may be invalid too.
      ({ checked } = this.#memory.guard('A frame', ADVICE, work, this.isChecking));
    } catch (error) {
      if (parts.isDestroyed) {
        const sound = this.#free(plan, error as Error);
        if (sound) void this.#view.restore(sound);
        this.error = null;
      }
      throw error;
    }
    if (!checked) {
      this.#takeSound(plan);
      return null;
    }
    const check = {};
    this.#check = check;
    const confirmed = checked.then(
      () => {
        if (check === this.#check) this.#check = null;
        if (parts === this.#view.parts()) this.#takeSound(plan);
      },
      (error: Error) => this.giveUp(plan, parts, error),
    );
    // Only callers that await the frame get the error.
    confirmed.catch(() => {});
    return confirmed;
  }

  /**
   * Frees a frame that lacked memory, draws the last sound one, then its successor: the newest
   * request, or the same request by quads.
   *
   * @param parts buffers and textures of the failed frame.
   * @throws `error` if there is no successor; else the successor's error.
   */
  async giveUp(plan: FramePlan, parts: HeldParts, error: Error): Promise<void> {
    // Later frames in the same memory are void for the same reason.
    if (parts !== this.#view.parts()) throw this.error ?? error;
    // The view has been destroyed.
    if (parts.isDestroyed) return;
    const sound = this.#free(plan, error);
    // Without the code, the driver frees the memory a little later; the lack of it is to be reported.
    const probe = await import('../gpu/probe-memory.ts').catch(() => null);
    await probe?.reclaimMemory(this.#memory.device);
    if (sound) await this.#view.restore(sound);
    if (this.#view.parts().isDestroyed) return;
    const isByChoice = hasChosenTiles(plan);
    const following = this.#view.drawSuccessor(isByChoice ? plan : null);
    // A newer request follows, so the error is not the last frame's.
    if (following) this.error = null;
    else if (!isByChoice) throw error;
    await following;
  }

  /** Frees the memory of a failed frame. @returns the sound frame to draw instead; null if none. */
  #free(plan: FramePlan, error: Error): FramePlan | null {
    const sound = this.#sound === plan ? this.#soundBefore : this.#sound;
    const { totalBytes } = this.#memory.report();
    const bytes = Math.max(totalBytes, (error as GpuLimitError).neededBytes ?? 0);
    this.#view.startOver();
    if (hasChosenTiles(plan)) {
      const [visibleSplats, pixels] = sizesOf(plan);
      this.#view.rejectTiles('tiles found no memory for their lists', { visibleSplats, pixels });
    } else {
      this.error ??= error;
      this.#lack ??= { sizes: sizesOf(plan), bytes, error, probedMs: Number.NEGATIVE_INFINITY };
    }
    return sound;
  }

  #takeSound(plan: FramePlan): void {
    if (plan !== this.#sound) this.#soundBefore = this.#sound;
    this.#sound = plan;
  }
}

/** Whether a plan uses tiles by choice of `auto`. */
function hasChosenTiles({ shape }: FramePlan): boolean {
  return shape.rasterizer === 'tiles' && shape.accuracy.rasterizer === 'auto';
}

/**
 * Sizes that decide how much memory a frame needs: visible splats, pixels of layer and image, and 1
 * for tiles or 0 for quads.
 */
function sizesOf({ shape, layer, request }: FramePlan): readonly number[] {
  const hasTiles = Number(shape.rasterizer === 'tiles');
  return [
    shape.visibleCapacity,
    layer.widthPx * layer.heightPx,
    request.widthPx * request.heightPx,
    hasTiles,
  ];
}
