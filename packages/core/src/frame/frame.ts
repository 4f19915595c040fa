import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { type Dispatch, recordDispatches } from '../gpu/passes.ts';
import type { CompiledStage } from '../gpu/pipelines.ts';
import type { TimedPass } from '../gpu/timing/frame-statistics.ts';
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
  readonly cut: Cut;
  readonly cull: Cull;
  readonly project: Project;
  readonly sort: Sort;
  readonly tileLists: TileLists;
  readonly resolveDepth: ResolveDepth;
  readonly tiles: Tiles;
  readonly quads: Quads;
  readonly upscale: Upscale;
  readonly composite: Composite;
  readonly compose: Compose;
  readonly shared = new SharedMemory();
  readonly timer: GpuTimer;
  readonly #memory: GpuMemory;
  readonly #parts: readonly FramePart[];
  #plan: FramePlan | null = null;
  /** Whether the buffers hold the visible splats of the plan in its order already. */
  #isColorsOnly = false;
  #isDestroyed = false;

  constructor(context: Omit<PartContext, 'shared'>) {
    const { shared } = this;
    const own = { ...context, memory: context.memory.part(), shared };
    this.#memory = own.memory;
    this.timer = new GpuTimer(own.device, own.memory);
    const cuts = new CutBuffers(own);
    this.inputs = new PageInputs(own, cuts);
    this.cut = new Cut(own, cuts);
    this.cull = new Cull(own);
    this.project = new Project(own);
    this.sort = new Sort(own);
    this.tileLists = new TileLists(own);
    this.resolveDepth = new ResolveDepth(own);
    this.tiles = new Tiles(own);
    this.quads = new Quads(own);
    this.upscale = new Upscale(own);
    this.composite = new Composite(own);
    this.compose = new Compose(own);
    this.#parts = [
      this.inputs,
      this.cut,
      this.cull,
      this.project,
      this.sort,
      this.tileLists,
      this.resolveDepth,
      this.tiles,
      this.quads,
      this.upscale,
      this.composite,
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
    const run = (label: string, timed: TimedPass, dispatches: readonly Dispatch[]) => {
      if (dispatches.length === 0) return;
      const pass = encoder.beginComputePass({ label, timestampWrites: this.timer.writes(timed) });
      recordDispatches(pass, dispatches);
      pass.end();
    };
    const { cut, cull, project, sort, tileLists } = this;
    if (this.#isColorsOnly) {
      run('pre-process', 'preprocess', project.records);
      return;
    }
    run('pre-process', 'preprocess', [...cut.dispatches, ...cull.dispatches, ...project.dispatches]);
    run('sort', 'sort', sort.dispatches);
    run('tile lists', 'tile-lists', tileLists.dispatches);
  }

  /** Records the visible splats to `destination`. @throws GpuLimitError before any is recorded. */
  recordDraw(encoder: GPUCommandEncoder, destination: Destination, sample: QuadsSample | null = null): void {
    const recording = { encoder, timer: this.timer, shape: this.shape!, destination, sample };
    if (destination.kind === 'host') this.compose.fitHost(recording.shape, destination.pass);
    this.resolveDepth.record(recording);
    // Before the tiles, which overwrite it.
    this.quads.recordSample(recording);
    this.tiles.record(recording);
    this.quads.record(recording);
    this.upscale.record(recording);
    this.composite.record(recording);
    this.compose.record(recording);
  }

  /** Records drawing the last image over another background. */
  recordBackground(encoder: GPUCommandEncoder, destination: Destination): void {
    this.composite.record({ encoder, timer: this.timer, shape: this.shape!, destination, sample: null });
  }

  /** Records the read-back of a drawn frame's counts. */
  recordCounts(encoder: GPUCommandEncoder): void {
    const { slotCount, visibleCount, tilePlan } = this.shared.buffers;
    const hasTiles = this.shape?.rasterizer === 'tiles';
    const { cutPlan } = this.cut;
    const plans = { ...(hasTiles && { tilePlan }), ...(cutPlan && { cutPlan }) };
    this.timer.record(encoder, { slotCount, visibleCount, ...plans });
  }

  destroy(): void {
    this.#isDestroyed = true;
    this.timer.destroy();
    this.#memory.destroyAll();
  }
}
