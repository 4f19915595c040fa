import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { CompiledStage } from '../gpu/pipelines.ts';
import { GpuTimer } from '../gpu/timing/gpu-timer.ts';
import { type FramePage, pagesOf } from './frame-pages.ts';
import {
  type Destination,
  type DrawRecording,
  type FramePart,
  type OrderRecording,
  type PartChange,
  type PartClass,
  type PartContext,
  type QuadsSample,
  SharedMemory,
} from './frame-part.ts';
import type { FramePlan } from './frame-plan.ts';
import { type FrameShape, perShape } from './frame-shape.ts';
import { Compose } from './parts/compose.ts';
import { Composite } from './parts/composite.ts';
import { Preprocess } from './parts/preprocess.ts';
import { Quads } from './parts/quads.ts';
import { ResolveDepth } from './parts/resolve-depth.ts';
import { Sort } from './parts/sort.ts';
import { TileLists } from './parts/tile-lists.ts';
import { Tiles } from './parts/tiles.ts';
import { Upscale } from './parts/upscale.ts';

// The order of a frame. Nothing else orders parts; each part orders its own stages.
//
// The visible splats are found and sorted, and then drawn. A view inside another renderer's frame
// submits the first half itself and records the second half for its host to submit.

/** Parts that find the visible splats, their order and, for tiles, their place. */
const ORDERING = [Preprocess, Sort, TileLists] as const satisfies readonly PartClass<OrderRecording>[];

/** Parts that draw the visible splats. Output, depth and scale of a shape decide which it uses. */
const DRAWING = [
  ResolveDepth,
  Tiles,
  Quads,
  Upscale,
  Composite,
  Compose,
] as const satisfies readonly PartClass<DrawRecording>[];

const PARTS = [...ORDERING, ...DRAWING] as const;

/** All stages that frames of this shape run; compile them before drawing. */
export const frameStages = perShape((shape): readonly CompiledStage[] =>
  PARTS.flatMap((part) => part.stages(shape)),
);

/** Parts of one view's frames, with their memory. Fit and record frames under `GpuMemory.guard`. */
export class FrameParts {
  readonly preprocess: Preprocess;
  readonly sort: Sort;
  readonly tileLists: TileLists;
  readonly resolveDepth: ResolveDepth;
  readonly quads: Quads;
  readonly composite: Composite;
  readonly compose: Compose;
  readonly shared = new SharedMemory();
  readonly timer: GpuTimer;
  readonly #memory: GpuMemory;
  readonly #ordering: readonly FramePart<OrderRecording>[];
  readonly #drawing: readonly FramePart<DrawRecording>[];
  readonly #parts: readonly FramePart<never>[];
  #plan: FramePlan | null = null;
  /** Whether the buffers hold the visible splats of the plan in its order already. */
  #isColorsOnly = false;
  #isDestroyed = false;

  constructor(context: Omit<PartContext, 'shared'>) {
    const { shared } = this;
    const own = { ...context, memory: context.memory.part(), shared };
    this.#memory = own.memory;
    this.timer = new GpuTimer(own.device, own.memory);
    this.#ordering = ORDERING.map((Part) => new Part(own));
    this.#drawing = DRAWING.map((Part) => new Part(own));
    this.#parts = [...this.#ordering, ...this.#drawing];
    this.preprocess = find(this.#ordering, Preprocess);
    this.sort = find(this.#ordering, Sort);
    this.tileLists = find(this.#ordering, TileLists);
    this.resolveDepth = find(this.#drawing, ResolveDepth);
    this.quads = find(this.#drawing, Quads);
    this.composite = find(this.#drawing, Composite);
    this.compose = find(this.#drawing, Compose);
  }

  /** Whether the parts have ended, and others are to be made. */
  get isDestroyed(): boolean {
    return this.#isDestroyed;
  }

  /** Shape of the last frame that room was made for; null before the first. */
  get shape(): FrameShape | null {
    return this.#plan?.shape ?? null;
  }

  /** Pages of the clouds of `shape`. */
  get pages(): readonly FramePage[] {
    return this.shape ? pagesOf(this.shape) : [];
  }

  /**
   * Makes room for a frame, binds its stages and writes its uniforms.
   *
   * @throws GpuLimitError if something exceeds the device's limits: nothing changes then. If it
   *   exceeds the engine's budget, or a device throws because memory is lacking, the replaced
   *   memory is gone, and the parts have ended.
   */
  fit(plan: FramePlan): void {
    const { shape } = plan;
    const changes: PartChange[] = [];
    for (const part of this.#parts) {
      const change = part.fit?.(plan);
      if (change) changes.push(change);
    }
    const isReplaced = changes.length > 0;
    try {
      // Old memory is freed before new is made: both together would be the most that a view holds.
      for (const change of changes) change.free();
      for (const change of changes) change.make();
      if (isReplaced || shape !== this.shape) for (const part of this.#parts) part.bind?.(shape);
    } catch (error) {
      this.destroy();
      throw error;
    }
    this.#plan = plan;
    this.#isColorsOnly = plan.keepsOrder && !isReplaced;
    for (const part of this.#parts) part.write?.(plan);
  }

  /** Records finding and sorting the visible splats. */
  recordOrder(encoder: GPUCommandEncoder): void {
    const { timer } = this;
    const recording = { encoder, timer, shape: this.shape!, isColorsOnly: this.#isColorsOnly };
    for (const part of this.#ordering) part.record(recording);
  }

  /** Records the visible splats to `destination`. @throws GpuLimitError before any is recorded. */
  recordDraw(encoder: GPUCommandEncoder, destination: Destination, sample: QuadsSample | null = null): void {
    const recording = { encoder, timer: this.timer, shape: this.shape!, destination, sample };
    if (destination.kind === 'host') this.compose.fitHost(recording.shape, destination.pass);
    for (const part of this.#drawing) {
      // Before the tiles, which overwrite it.
      if (part instanceof Tiles) this.quads.recordSample(recording);
      part.record(recording);
    }
  }

  /** Records drawing the last image over another background. */
  recordBackground(encoder: GPUCommandEncoder, destination: Destination): void {
    this.composite.record({ encoder, timer: this.timer, shape: this.shape!, destination, sample: null });
  }

  /** Records the read-back of a drawn frame's counts. */
  recordCounts(encoder: GPUCommandEncoder): void {
    const { slotCount, visibleCount, tilePlan } = this.shared.buffers;
    const hasTiles = this.shape?.rasterizer === 'tiles';
    const { cutPlan } = this.preprocess;
    const plans = { ...(hasTiles && { tilePlan }), ...(cutPlan && { cutPlan }) };
    this.timer.record(encoder, { slotCount, visibleCount, ...plans });
  }

  destroy(): void {
    this.#isDestroyed = true;
    this.timer.destroy();
    this.#memory.destroyAll();
  }
}

function find<R extends OrderRecording | DrawRecording, Part extends FramePart<R>>(
  parts: readonly FramePart<R>[],
  type: new (context: PartContext) => Part,
): Part {
  return parts.find((part) => part instanceof type) as Part;
}
