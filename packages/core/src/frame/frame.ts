import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { type ComputePass, type FramePass, recordPass } from '../gpu/passes.ts';
import type { CompiledStage } from '../gpu/pipelines.ts';
import { GpuTimer } from '../gpu/timing/gpu-timer.ts';
import { CutBuffers } from './cut-buffers.ts';
import { type FramePage, pagesOf } from './frame-pages.ts';
import {
  type Destination,
  type FramePart,
  type PartChange,
  type PartContext,
  type QuadsSample,
  SharedMemory,
} from './frame-part.ts';
import type { FramePlan } from './frame-plan.ts';
import { type FrameShape, perShape } from './frame-shape.ts';
import { Compose } from './parts/compose.ts';
import { Composite } from './parts/composite.ts';
import { Cull } from './parts/cull.ts';
import { Cut } from './parts/cut.ts';
import { PageInputs } from './parts/page-inputs.ts';
import { Project } from './parts/project.ts';
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

/** Parts that run stages. */
const STAGED_PARTS = [
  Cut,
  Cull,
  Project,
  Sort,
  TileLists,
  ResolveDepth,
  Tiles,
  Quads,
  Upscale,
  Composite,
  Compose,
];

/** All stages that frames of this shape run; compile them before drawing. */
export const frameStages = perShape((shape): readonly CompiledStage[] =>
  STAGED_PARTS.flatMap((part) => part.stages(shape)),
);

/** Parts of one view's frames, with their memory. Fit and record frames under `GpuMemory.guard`. */
export class FrameParts {
  readonly inputs: PageInputs;
  readonly sort: Sort;
  readonly tileLists: TileLists;
  readonly resolveDepth: ResolveDepth;
  readonly compose: Compose;
  readonly shared = new SharedMemory();
  readonly timer: GpuTimer;
  /** Passes that find and sort the visible splats; fewer if only their colours have changed. */
  orderPasses: readonly ComputePass[] = [];
  readonly #memory: GpuMemory;
  readonly #cut: Cut;
  readonly #cull: Cull;
  readonly #project: Project;
  readonly #tiles: Tiles;
  readonly #quads: Quads;
  readonly #upscale: Upscale;
  readonly #composite: Composite;
  readonly #parts: readonly FramePart[];
  #plan: FramePlan | null = null;
  /** Passes of frames of the bound shape, and of frames in which only colours have changed. */
  #order: readonly ComputePass[] = [];
  #recolor: readonly ComputePass[] = [];
  #isDestroyed = false;

  constructor(context: Omit<PartContext, 'shared'>) {
    const { shared } = this;
    const own = { ...context, memory: context.memory.part(), shared };
    this.#memory = own.memory;
    this.timer = new GpuTimer(own.device, own.memory);
    const cuts = new CutBuffers(own);
    this.inputs = new PageInputs(own, cuts);
    this.#cut = new Cut(own, cuts);
    this.#cull = new Cull(own);
    this.#project = new Project(own);
    this.sort = new Sort(own);
    this.tileLists = new TileLists(own);
    this.resolveDepth = new ResolveDepth(own);
    this.#tiles = new Tiles(own);
    this.#quads = new Quads(own);
    this.#upscale = new Upscale(own);
    this.#composite = new Composite(own);
    this.compose = new Compose(own);
    this.#parts = [
      this.inputs,
      this.#cut,
      this.#cull,
      this.#project,
      this.sort,
      this.tileLists,
      this.resolveDepth,
      this.#tiles,
      this.#quads,
      this.#upscale,
      this.#composite,
      this.compose,
    ];
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
      if (isReplaced || shape !== this.shape) this.#bind(shape);
    } catch (error) {
      this.destroy();
      throw error;
    }
    this.#plan = plan;
    this.orderPasses = plan.keepsOrder && !isReplaced ? this.#recolor : this.#order;
    for (const part of this.#parts) part.write?.(plan);
  }

  /** Binds the stages of `shape`, and lists the passes that find and sort its splats. */
  #bind(shape: FrameShape): void {
    for (const part of this.#parts) part.bind?.(shape);
    const preprocess = { label: 'pre-process', timed: 'preprocess' } as const;
    this.#recolor = [{ ...preprocess, dispatches: this.#project.records }];
    const order: ComputePass[] = [
      {
        ...preprocess,
        dispatches: [...this.#cut.dispatches, ...this.#cull.dispatches, ...this.#project.dispatches],
      },
      { label: 'sort', timed: 'sort', dispatches: this.sort.dispatches },
      { label: 'tile lists', timed: 'tile-lists', dispatches: this.tileLists.dispatches },
    ];
    this.#order = order.filter(({ dispatches }) => dispatches.length > 0);
  }

  /** Lists passes that draw the visible splats to `destination`. @throws GpuLimitError */
  drawPasses(destination: Destination, sample: QuadsSample | null = null): readonly FramePass[] {
    const shape = this.shape!;
    const drawing = { shape, destination, sample };
    if (destination.kind === 'host') this.compose.fitHost(shape, destination.pass);
    return [
      this.resolveDepth.pass(drawing),
      // Before the tiles, which overwrite it.
      this.#quads.samplePass(drawing),
      this.#tiles.pass(shape),
      this.#quads.pass(shape),
      this.#upscale.pass,
      this.#composite.pass(shape, destination),
      this.compose.pass(drawing),
    ].filter((pass) => pass !== null);
  }

  /** Lists passes that draw the last image over another background. */
  backgroundPasses(destination: Destination): readonly FramePass[] {
    return [this.#composite.pass(this.shape!, destination)].filter((pass) => pass !== null);
  }

  /** Records passes as part of the frame that the timer measures. */
  record(encoder: GPUCommandEncoder, passes: readonly FramePass[]): void {
    for (const pass of passes) recordPass(encoder, pass, this.timer.writes(pass.timed));
  }

  /** Records the read-back of a drawn frame's counts. */
  recordCounts(encoder: GPUCommandEncoder): void {
    const { slotCount, visibleCount, tilePlan } = this.shared.buffers;
    const hasTiles = this.shape?.rasterizer === 'tiles';
    const { cutPlan } = this.#cut;
    const plans = { ...(hasTiles && { tilePlan }), ...(cutPlan && { cutPlan }) };
    this.timer.record(encoder, { slotCount, visibleCount, ...plans });
  }

  destroy(): void {
    this.#isDestroyed = true;
    this.timer.destroy();
    this.#memory.destroyAll();
  }
}
