import type { GpuLimitError } from '../data/errors.ts';
import type { FrameParts } from '../frame/frame.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { RasterizerChoice } from './rasterizer-choice.ts';

type HeldParts = Pick<FrameParts, 'isDestroyed'>;

/** Actions of a view whose frame finds no memory. */
export interface RecoveringView {
  /** The buffers and textures of its frames. Others take their place when the view starts over. */
  parts(): HeldParts;
  /** Frees them, and forgets the last frame. */
  startOver(): void;
  /** Leaves frames of this load, which tiles cannot draw, to quads. */
  rejectTiles: RasterizerChoice['rejectTiles'];
  /** Draws a sound frame again, unless another was drawn since. Resolves when that has ended. */
  restore(sound: FramePlan): Promise<void>;
  /**
   * Draws the replacement of a frame: the request that waits for it or, if `again` is still the
   * newest, that one.
   *
   * @returns a promise that settles when that has been drawn; null if nothing follows.
   */
  follow(again: FramePlan | null): Promise<void> | null;
}

/** A frame that found no memory. */
interface Lack {
  readonly sizes: readonly number[];
  /** Bytes that the view would hold with that frame. */
  readonly bytes: number;
  readonly error: Error;
  /** When it was last asked whether there is memory by now. */
  probedMs: number;
}

const ADVICE = 'Draw a smaller image, or with a coarser accuracy or by quads, or load fewer splats.';

/** Shortest time between two probes for memory, ms: a page may draw sixty times a second. */
const PROBE_PAUSE_MS = 250;

/**
 * Recovers from frames that find no memory, which the device tells later: frees theirs, draws the
 * last sound frame again, tells the error once, and looks for memory before a frame as large is
 * drawn.
 */
export class MemoryRecovery {
  /** Why the last frame could not be drawn; cleared once a caller knows or another is drawn. */
  error: Error | null = null;
  readonly #memory: GpuMemory;
  readonly #view: RecoveringView;
  /** The last frame that had memory, and the one before: dividing a frame takes memory, too. */
  #sound: FramePlan | null = null;
  #soundBefore: FramePlan | null = null;
  /** The newest of the checks under way. */
  #check: object | null = null;
  /** The frame that found no memory, as long as none so large has. */
  #lack: Lack | null = null;

  /** @param memory all that the view holds. */
  constructor(memory: GpuMemory, view: RecoveringView) {
    this.#memory = memory;
    this.#view = view;
  }

  /** Whether the device has not yet said if it had memory for the last frames. */
  get isChecking(): boolean {
    return this.#check !== null;
  }

  /** Whether a probe for the memory that is lacking is due. */
  get isProbeDue(): boolean {
    return this.#lack !== null && performance.now() - this.#lack.probedMs > PROBE_PAUSE_MS;
  }

  /** Whether `plan` needs as much memory as the frame that found none. */
  lacksRoomFor(plan: FramePlan): boolean {
    if (!this.#lack) return false;
    const { sizes } = this.#lack;
    return sizesOf(plan).every((size, i) => size >= sizes[i]);
  }

  /** Asks whether there is memory by now. @throws the error of the frame that lacked it, if not. */
  async findRoom(): Promise<void> {
    const lack = this.#lack;
    if (!lack) return;
    lack.probedMs = performance.now();
    // Few pages ever lack memory.
    const { probeMemory } = await import('../gpu/probe-memory.ts');
    const isThere = await probeMemory(this.#memory, lack.bytes - this.#memory.report().totalBytes);
    if (!isThere) throw lack.error;
    this.#lack = null;
  }

  /** Forgets which frames were sound: their buffers are gone. */
  forget(): void {
    this.#sound = this.#soundBefore = null;
    this.#check = null;
  }

  /**
   * Makes room for a frame, and records and submits it, by `work`. If memory is lacking for it,
   * which the device tells later, the last sound frame is drawn again.
   *
   * @returns a promise that settles when the device has told, and rejects if the frame was void and
   *   nothing follows; null if the frame takes no more than those before.
   * @throws GpuLimitError if limits or the engine's budget do not allow the frame; the last one
   *   stays, or is drawn again.
   */
  draw(plan: FramePlan, work: () => void): Promise<void> | null {
    const parts = this.#view.parts();
    let checked: Promise<void> | null;
    try {
      // A frame in memory that is still being checked may be as invalid as that.
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
    const told = checked.then(
      () => {
        if (check === this.#check) this.#check = null;
        if (parts === this.#view.parts()) this.#takeSound(plan);
      },
      (error: Error) => this.giveUp(plan, parts, error),
    );
    // Only callers that await the frame get the error.
    told.catch(() => {});
    return told;
  }

  /**
   * Frees a frame that found no memory, draws the last sound one, and lets another take its place:
   * the newest request, or the same one by quads.
   *
   * @param parts those of the frame.
   * @throws `error` if none follows; else why that one could not be drawn.
   */
  async giveUp(plan: FramePlan, parts: HeldParts, error: Error): Promise<void> {
    // Frames that followed in the same memory are void for the same reason.
    if (parts !== this.#view.parts()) throw this.error ?? error;
    // The view has ended.
    if (parts.isDestroyed) return;
    const sound = this.#free(plan, error);
    const { reclaimMemory } = await import('../gpu/probe-memory.ts');
    await reclaimMemory(this.#memory.device);
    if (sound) await this.#view.restore(sound);
    if (this.#view.parts().isDestroyed) return;
    const isByChoice = hasChosenTiles(plan);
    const following = this.#view.follow(isByChoice ? plan : null);
    // Then this was not the last one.
    if (following) this.error = null;
    else if (!isByChoice) throw error;
    await following;
  }

  /** Frees the memory of a frame that lacks some. @returns the frame to draw again instead. */
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

/** Whether a plan has tiles that were not asked for. */
function hasChosenTiles({ shape }: FramePlan): boolean {
  return shape.rasterizer === 'tiles' && shape.accuracy.rasterizer === 'auto';
}

/**
 * Numbers that decide how much memory a frame needs: visible splats, pixels of the layer, pixels of
 * the image, and whether by tiles.
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
