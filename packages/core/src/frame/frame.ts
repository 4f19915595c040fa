import {
  type ComputePass,
  type Dispatch,
  dispatchOf,
  type FramePass,
  ONE_WORKGROUP,
  recordPass,
} from '../gpu/passes.ts';
import { type Bindings, type RenderStage, type StageDefinition, stageNameOf } from '../gpu/pipelines.ts';
import { GpuTimer } from '../gpu/timing/gpu-timer.ts';
import { type FramePage, pagesOf } from './frame-pages.ts';
import {
  type AimedFrame,
  type BoundFrame,
  boundNames,
  CANVAS_PASSES,
  DRAW_PASSES,
  ORDER_PASSES,
  type OrderStage,
  type StageRow,
  stagesOf,
} from './frame-passes.ts';
import {
  type Destination,
  type FramePart,
  type PartChange,
  type PartContext,
  type QuadsSample,
  SharedMemory,
  type StageTarget,
} from './parts/frame-part.ts';
import { HostTextures, isMultisampled } from './parts/host-textures.ts';
import { Layer } from './parts/layer.ts';
import { PageInputs } from './parts/page-inputs.ts';
import { LongTiles, TileLists } from './parts/tile-lists.ts';
import { Sort, VisibleSplats } from './parts/visible-splats.ts';
import type { FramePlan } from './plan/frame-plan.ts';
import type { FrameShape } from './plan/frame-shape.ts';

/** A bind group of a row, and what it was made of. */
interface MadeGroup {
  readonly stage: StageDefinition;
  readonly bound: readonly Bindings[string][];
  readonly group: GPUBindGroup;
}

/** Memory and passes of one view's frames. Fit and record frames under `GpuMemory.guard`. */
export class FrameParts {
  readonly inputs: PageInputs;
  readonly sort: Sort;
  readonly tileLists: TileLists;
  readonly host: HostTextures;
  readonly shared = new SharedMemory();
  readonly timer: GpuTimer;
  /** Passes that find and sort the visible splats; fewer if only their colours have changed. */
  orderPasses: readonly ComputePass[] = [];
  readonly #context: PartContext;
  readonly #parts: readonly FramePart[];
  #plan: FramePlan | null = null;
  /** Passes of frames of the bound shape, and of frames in which only colours have changed. */
  #order: readonly ComputePass[] = [];
  #recolor: readonly ComputePass[] = [];
  /** Of rows that draw: hosts may replace their textures between two frames, but most do not. */
  readonly #groups = new Map<StageRow, MadeGroup>();
  /** The bound shape, with its memory. */
  #frame: BoundFrame | null = null;
  #isDestroyed = false;

  constructor(context: Omit<PartContext, 'shared'>) {
    const own = { ...context, memory: context.memory.part(), shared: this.shared };
    this.#context = own;
    this.timer = new GpuTimer(own.device, own.memory);
    this.inputs = new PageInputs(own);
    this.sort = new Sort(own);
    this.tileLists = new TileLists(own);
    this.host = new HostTextures(own);
    this.#parts = [
      this.inputs,
      new VisibleSplats(own),
      this.sort,
      this.tileLists,
      new LongTiles(own),
      new Layer(own),
      this.host,
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

  /** Binds the stages that find and sort the splats of `shape`. */
  #bind(shape: FrameShape): void {
    for (const part of this.#parts) part.bind?.(shape);
    const { resources } = this.shared;
    const { sort: pairSort, pairCapacity } = this.tileLists;
    const frame = { shape, resources, sort: this.sort.sort, pairSort, pairCapacity };
    this.#frame = frame;
    this.#order = ORDER_PASSES.map(({ stages, ...pass }) => ({
      ...pass,
      dispatches: stages.flatMap((row) => this.#dispatches(row, frame)),
    })).filter(({ dispatches }) => dispatches.length > 0);
    const writesRecords = ({ pipeline }: Dispatch) => stageNameOf(pipeline) === 'project';
    const [preprocess] = this.#order;
    this.#recolor = [{ ...preprocess, dispatches: preprocess.dispatches.filter(writesRecords) }];
  }

  /** Dispatches of a row, one after another if it runs over pages or batches. */
  #dispatches(row: OrderStage, frame: BoundFrame): readonly Dispatch[] {
    if ('dispatches' in row) return row.dispatches(frame);
    const stages = stagesOf(frame.shape).get(row)!;
    const whole: StageTarget = { cloudIndex: 0, isBlobs: false, count: 0, resources: frame.resources };
    const { pages, batches } = this.shared;
    const { pipelines } = this.#context;
    const targets = row.each ? (row.each === 'page' ? pages : batches) : [whole];
    return targets.flatMap(({ cloudIndex, isBlobs, count, resources, effects }, index) => {
      const stage = stages[cloudIndex][Number(isBlobs)] as StageDefinition | null;
      if (!stage) return [];
      const bound = boundNames.get(row)!.map(([name, resource = name]) => [name, resources[resource]]);
      const size = row.each ? row.size(count, frame, index) : (row.size?.(frame) ?? ONE_WORKGROUP);
      return [dispatchOf(pipelines, stage, { ...Object.fromEntries(bound), ...effects }, size)];
    });
  }

  /** Lists passes that draw the visible splats to `destination`. @throws GpuLimitError */
  drawPasses(destination: Destination, sample: QuadsSample | null = null): readonly FramePass[] {
    return this.#drawn(DRAW_PASSES, destination, sample);
  }

  /** Lists passes that draw the last image over another background. */
  backgroundPasses(destination: Destination): readonly FramePass[] {
    return this.#drawn(CANVAS_PASSES, destination, null);
  }

  #drawn(passes: typeof DRAW_PASSES, destination: Destination, sample: QuadsSample | null): FramePass[] {
    const frame = { ...this.#frame!, destination, sample };
    for (const part of this.#parts) part.aim?.(frame);
    return passes.map((pass) => this.#drawPass(pass, frame)).filter((pass) => pass !== null);
  }

  /** Null if no stage of the pass runs. */
  #drawPass(pass: (typeof DRAW_PASSES)[number], frame: AimedFrame): FramePass | null {
    const { label, timed, to, copies } = pass;
    if (to && to !== frame.destination.kind) return null;
    const { pipelines } = this.#context;
    const isMany = isMultisampled(frame.destination);
    const dispatches: Dispatch[] = [];
    for (const row of pass.stages) {
      const [[one, many]] = stagesOf(frame.shape).get(row)!;
      const compiled = (isMany && many) || one;
      if (!compiled) continue;
      const stage = 'stage' in compiled ? compiled : compiled[0];
      if (row.targets) {
        const draws = row.draws(frame);
        if (!draws) return null;
        const pipeline = pipelines.render(...(compiled as RenderStage))!;
        const group = this.#group(row, stage);
        return { label, timed, targets: row.targets(frame), pipeline, group, draws };
      }
      const group = this.#group(row, stage);
      const size = row.size?.(frame) ?? ONE_WORKGROUP;
      dispatches.push({ pipeline: pipelines.compute(stage)!, group, size });
    }
    return dispatches.length > 0 ? { label, timed, ...copies?.(frame), dispatches } : null;
  }

  /** The bind group of a row; the last one if it binds the same. */
  #group(row: StageRow, stage: StageDefinition): GPUBindGroup {
    const { resources } = this.shared;
    const names = boundNames.get(row)!;
    const made = this.#groups.get(row);
    if (made?.stage === stage && names.every(([name, from = name], i) => resources[from] === made.bound[i]))
      return made.group;
    const bound = names.map(([name, from = name]) => resources[from]);
    const byName = Object.fromEntries(names.map(([name], i) => [name, bound[i]]));
    const group = this.#context.pipelines.bindGroup(stage, byName);
    this.#groups.set(row, { stage, bound, group });
    return group;
  }

  /** Records passes as part of the frame that the timer measures. */
  record(encoder: GPUCommandEncoder, passes: readonly FramePass[]): void {
    for (const pass of passes) recordPass(encoder, pass, this.timer.writes(pass.timed));
  }

  /** Records the read-back of a drawn frame's counts. */
  recordCounts(encoder: GPUCommandEncoder): void {
    const { slotCount, visibleCount, tilePlan, cutPlan } = this.shared.resources;
    const hasTiles = this.shape?.rasterizer === 'tiles';
    this.timer.record(encoder, {
      slotCount,
      visibleCount,
      ...(hasTiles && { tilePlan }),
      ...(cutPlan && { cutPlan }),
    });
  }

  destroy(): void {
    this.#isDestroyed = true;
    this.timer.destroy();
    this.#context.memory.destroyAll();
  }
}
