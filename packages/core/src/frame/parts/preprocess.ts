import { maxColor } from '../../data/accuracy/accuracy.ts';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { CullParameters, PagePlan, SPLAT_RECORDS, View } from '../../data/layout/structs.ts';
import { BLOB_PRECISION } from '../../data/packing/precision.ts';
import { antialias } from '../../gpu/effects/antialias/antialias.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings, CompiledStage, StageDefinition } from '../../gpu/pipelines.ts';
import {
  compactChunks,
  compactSplats,
  cullChunks,
  cullSplats,
  PrefixScan,
  planCull,
  prefixScanStages,
} from '../../stages/cull/cull.ts';
import {
  countWorkgroups,
  cutCells,
  cutCount,
  cutSplats,
  cutWorkgroups,
  planCut,
  shiftCells,
} from '../../stages/cut/cut.ts';
import { dispatchAtMost, dispatchSize, type IndirectArguments } from '../../stages/dispatch.ts';
import { planProject, project } from '../../stages/project/project.ts';
import { wideKeys } from '../../stages/wide-keys/wide-keys.ts';
import { CutBuffers } from '../cut-buffers.ts';
import { EffectBuffers } from '../effect-buffers.ts';
import {
  batchInstances,
  type FramePage,
  pagesOf,
  projectWorkgroups,
  totalChunks,
  uniformBytes,
} from '../frame-pages.ts';
import {
  type FramePart,
  type OrderRecording,
  type PartChange,
  type PartContext,
  type SharedBuffers,
  useCompute,
} from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, hasSameBuffers, hasWideKeys, perShape } from '../frame-shape.ts';
import { viewUniforms, writePageUniforms } from '../frame-uniforms.ts';
import { WidePlaces } from '../wide-places.ts';

/** Names, sizes and usages of the part's buffers; stages bind them by these names. */
function bufferTable({ accuracy, visibleCapacity }: FrameShape, pages: readonly FramePage[]) {
  const [pageCount, chunkCount] = [pages.length, totalChunks(pages)];
  const { STORAGE, UNIFORM, INDIRECT } = GPUBufferUsage;
  const record = SPLAT_RECORDS[accuracy.recordPrecision];
  return {
    view: [View.bytes, UNIFORM],
    pageUniforms: [uniformBytes(pages.map(({ uniform }) => uniform)), UNIFORM],
    cullParameters: [CullParameters.bytes, UNIFORM],
    chunkCount: [4, STORAGE],
    /** Per chunk: 1 if it is visible; after the scan, the number of visible chunks before it. */
    chunkOffsets: [4 * (chunkCount + 1), STORAGE],
    visibleChunks: [4 * chunkCount, STORAGE],
    /** Number of visible chunks: each has a slot, numbered in storage order. */
    slotCount: [4, STORAGE],
    /** Per slot: a bit per splat. */
    visibilityMasks: [(CHUNK_SPLATS / 8) * chunkCount, STORAGE],
    /** Per slot: its number of visible splats; after the prefix scan, the sum of all earlier slots. */
    splatOffsets: [4 * (chunkCount + 1), STORAGE],
    // A binding holds at least one element, even if there is nothing to draw.
    pagePlans: [PagePlan.bytes * Math.max(1, pageCount), STORAGE],
    depthRange: [8, STORAGE | UNIFORM],
    cullDispatches: [12 * (pageCount + 1), STORAGE | INDIRECT],
    projectDispatches: [12 * pageCount, STORAGE | INDIRECT],
    drawArguments: [16, STORAGE | INDIRECT],
    /** The visible splats in storage order. */
    visibleSplats: [4 * visibleCapacity, STORAGE],
    records: [record.bytes * Math.max(1, visibleCapacity), STORAGE],
  } as const satisfies Partial<
    Record<keyof SharedBuffers, readonly [bytes: number, usage: GPUBufferUsageFlags]>
  >;
}

type BufferName = keyof ReturnType<typeof bufferTable>;
type Buffers = Readonly<Record<BufferName, GPUBuffer>>;

/** The part's memory for frames that have the same buffers. */
interface Held {
  readonly buffers: Buffers;
  readonly scans: { readonly chunks: PrefixScan; readonly splats: PrefixScan };
  /** The shape that the buffers were made for. */
  readonly shape: FrameShape;
}

/** Stages that run once in a frame. */
const FRAME_STAGES = [compactChunks, planCull, planProject, compactSplats] as const;

/** A dispatch over the cells of one batch of a cloud's instances. */
interface CellDispatch {
  readonly stage: StageDefinition;
  readonly group: GPUBindGroup;
  readonly thresholdCount: number;
}

interface Groups {
  /** Of all clouds with a cut. */
  readonly cuts: readonly CellDispatch[];
  /** Of the frame's budget; null without one. */
  readonly budget: { readonly plan: GPUBindGroup; readonly shifts: readonly CellDispatch[] } | null;
  readonly frame: ReadonlyMap<StageDefinition, GPUBindGroup>;
  readonly pages: readonly {
    /** The bindings of all these. */
    readonly own: Bindings;
    readonly cullChunks: GPUBindGroup;
    /** Null on pages without a cut. */
    readonly cutSplats: GPUBindGroup | null;
    /** Null without a budget. */
    readonly cutCount: GPUBindGroup | null;
    readonly cullSplats: GPUBindGroup;
    readonly project: GPUBindGroup;
    /** Null without wide keys. */
    readonly wideKeys: GPUBindGroup | null;
  }[];
}

/** The stages that differ between clouds, by cloud of the frame. */
const cloudStages = perShape((shape) =>
  shape.clouds.map((cloud) => {
    const { accuracy, shortensKeys } = shape;
    // Inputs of variants have one name everywhere; planes at hand may differ from the settings'.
    const batch = cloud.instanceCount === null ? null : batchInstances(cloud);
    const variant = { ...accuracy, ...shape, ...cloud.planes, ...cloud, batchInstances: batch };
    const hasLevels = cloud.levels !== null;
    const isBudgeted = hasLevels && shape.isBudgeted;
    const cuts = {
      ...(hasLevels && { cutCells: cutCells(batch ?? 1), cutSplats: cutSplats(batch) }),
      ...(isBudgeted && { shiftCells: shiftCells(batch ?? 1) }),
    };
    const stagesOf = (own: typeof variant & { readonly isDilated?: boolean }) => ({
      ...cuts,
      cullChunks: cullChunks({ hasLevels, batchInstances: batch }),
      ...(isBudgeted && { cutCount: cutCount(own) }),
      cullSplats: cullSplats({ ...own, hasLevels }),
      project: project({
        ...own,
        shortKeyBits: shortensKeys ? accuracy.sortKeyBits : null,
        maxColor: maxColor(accuracy),
        storedShDegree: cloud.cloud.shDegree,
      }),
      ...(hasWideKeys(shape) && { wideKeys: wideKeys(own) }),
    });
    const splats = stagesOf(variant);
    if (!cloud.levels) return { splats, blobs: splats };
    const isDilated = !cloud.effects.effects.includes(antialias.effect);
    return { splats, blobs: stagesOf({ ...variant, ...BLOB_PRECISION, isDilated }) };
  }),
);

/** The stages of one page. */
function stagesOf(shape: FrameShape, { cloudIndex, isBlobs }: FramePage) {
  const { splats, blobs } = cloudStages(shape)[cloudIndex];
  return isBlobs ? blobs : splats;
}

/** Finds the visible splats, lists them in storage order, and writes their records and keys. */
export class Preprocess implements FramePart<OrderRecording> {
  readonly #context: PartContext;
  /** Memory of `#held`. */
  readonly #memory: GpuMemory;
  readonly #effects: EffectBuffers;
  readonly #cuts: CutBuffers;
  readonly #widePlaces: WidePlaces;
  #held: Held | null = null;
  #pageContents = new ArrayBuffer(0);
  #groups: Groups | null = null;

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
    this.#effects = new EffectBuffers(context.memory, context.device.queue);
    this.#cuts = new CutBuffers(context);
    this.#widePlaces = new WidePlaces(context.memory, context.device.queue);
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    const clouds = cloudStages(shape).flatMap(({ splats, blobs }) =>
      [...new Set([splats, blobs])].flatMap((own) => Object.values<CompiledStage>(own)),
    );
    const touched = shape.clouds.flatMap(({ isTouched, levels }) =>
      isTouched ? levels!.refinement!.stages : [],
    );
    const budget = shape.isBudgeted ? [planCut] : [];
    return [...FRAME_STAGES, ...touched, ...budget, ...prefixScanStages, ...clouds];
  }

  /** Bytes of the levels of one cloud's chunks. */
  levelBytes(cloudIndex: number): number {
    return this.#effects.levelBytes(cloudIndex);
  }

  /** Bytes of one cloud's selection bits. */
  selectionBytes(cloudIndex: number): number {
    return this.#effects.selectionBytes(cloudIndex);
  }

  fit({ shape }: FramePlan): PartChange | null {
    const held = this.#held;
    if (held && hasSameBuffers(held.shape, shape)) return null;
    const { shared } = this.#context;
    const pages = pagesOf(shape);
    // The largest buffers of a frame, besides the pairs', whose number is limited.
    const table = bufferTable(shape, pages);
    for (const name of ['records', 'visibilityMasks'] as const)
      this.#memory.check(`frame ${name}`, ...table[name]);
    return {
      free: () => this.#memory.destroyAll(),
      make: () => {
        this.#held = this.#make(shape, pages);
        Object.assign(shared.buffers, this.#held.buffers);
      },
    };
  }

  /** One `CutPlan`; null where no budget limits the frame. */
  get cutPlan(): GPUBuffer | null {
    return this.#cuts.budgetBindings?.cutPlan ?? null;
  }

  bind(shape: FrameShape): void {
    const { pipelines, shared } = this.#context;
    const { buffers } = shared;
    this.#effects.fit(shape);
    this.#cuts.fit(shape);
    this.#widePlaces.fit(shape);
    const cellDispatches = (name: 'cutCells' | 'shiftCells') =>
      shape.clouds.flatMap((_, i) =>
        this.#cuts.batchesOf(i).map(({ own, thresholdCount }): CellDispatch => {
          const stage = cloudStages(shape)[i].splats[name]!;
          return { stage, group: pipelines.bindGroup(stage, own), thresholdCount };
        }),
      );
    const budget = this.#cuts.budgetBindings;
    this.#groups = {
      cuts: cellDispatches('cutCells'),
      budget: budget && {
        plan: pipelines.bindGroup(planCut, budget),
        shifts: cellDispatches('shiftCells'),
      },
      frame: new Map(FRAME_STAGES.map((stage) => [stage, pipelines.bindGroup(stage, buffers)])),
      pages: pagesOf(shape).map((framePage, index) => {
        const { chunks, geometry, shRest, instances, uniform } = framePage;
        const stages = stagesOf(shape, framePage);
        const own = {
          ...buffers,
          [instances ? 'pages' : 'page']: { buffer: buffers.pageUniforms, ...uniform },
          chunks,
          geometry,
          ...(shRest && { shRest }),
          ...this.#cuts.bindingsOf(framePage),
          ...this.#effects.bindingsOf(index),
          ...this.#widePlaces.bindingsOf(index),
        };
        return {
          own,
          cullChunks: pipelines.bindGroup(stages.cullChunks, own),
          cutSplats: stages.cutSplats ? pipelines.bindGroup(stages.cutSplats, own) : null,
          cutCount: stages.cutCount ? pipelines.bindGroup(stages.cutCount, own) : null,
          cullSplats: pipelines.bindGroup(stages.cullSplats, own),
          project: pipelines.bindGroup(stages.project, own),
          wideKeys: stages.wideKeys ? pipelines.bindGroup(stages.wideKeys, own) : null,
        };
      }),
    };
  }

  write(plan: FramePlan): void {
    const { queue } = this.#context.device;
    const { view, pageUniforms } = this.#held!.buffers;
    queue.writeBuffer(view, 0, viewUniforms(plan));
    const bytes = pageUniforms.size;
    if (this.#pageContents.byteLength !== bytes) this.#pageContents = new ArrayBuffer(bytes);
    writePageUniforms(plan, this.#pageContents);
    // Deno 2.9 ends at a write of no bytes.
    if (bytes > 0) queue.writeBuffer(pageUniforms, 0, this.#pageContents);
    this.#effects.write(plan);
    this.#cuts.write(plan, this.#groups!.pages);
    this.#widePlaces.write(plan);
  }

  record({ encoder, timer, shape, isColorsOnly }: OrderRecording): void {
    const pass = encoder.beginComputePass({
      label: 'pre-process',
      timestampWrites: timer.writes('preprocess'),
    });
    const pages = pagesOf(shape);
    if (!isColorsOnly) {
      this.#recordCulling(pass, shape, pages);
      this.#useOnce(pass, planProject);
      pass.dispatchWorkgroups(1);
    }
    // The order of the last frame stands where only colours have changed.
    for (const name of ['project', ...(isColorsOnly ? [] : (['wideKeys'] as const))] as const) {
      let stage: StageDefinition | null = null;
      for (const [index, framePage] of pages.entries()) {
        const next = stagesOf(shape, framePage)[name];
        if (!next) continue;
        stage = this.#usePipeline(pass, next, stage);
        pass.setBindGroup(0, this.#groups!.pages[index][name]);
        const indirect = { buffer: this.#held!.buffers.projectDispatches, offset: 12 * index };
        dispatchWithin(pass, projectWorkgroups(framePage.chunkCount), shape, indirect);
      }
    }
    pass.end();
  }

  /** Lists the visible splats in storage order. */
  #recordCulling(pass: GPUComputePassEncoder, shape: FrameShape, pages: readonly FramePage[]): void {
    const { buffers, scans } = this.#held!;
    const groups = this.#groups!;
    // At least one workgroup: Dawn warns about empty dispatches.
    const chunkWorkgroups = (chunks: number) =>
      dispatchSize(Math.max(1, Math.ceil(chunks / SHADER_CONSTANTS.CHUNK_WORKGROUP)), shape.dispatchRow);
    const overCells = (dispatches: readonly CellDispatch[]) => {
      for (const { stage, group, thresholdCount } of dispatches) {
        useCompute(pass, this.#context.pipelines, stage, group);
        pass.dispatchWorkgroups(...chunkWorkgroups(thresholdCount));
      }
    };
    overCells(groups.cuts);
    if (groups.budget) {
      // The first search narrows the thresholds to a step of 64 codes, the second to one code.
      this.#recordBudget(pass, shape, pages, groups.budget.plan);
      this.#recordBudget(pass, shape, pages, groups.budget.plan);
      overCells(groups.budget.shifts);
    }
    let stage: StageDefinition | null = null;
    for (const [index, framePage] of pages.entries()) {
      const { chunkCount } = framePage;
      stage = this.#usePipeline(pass, stagesOf(shape, framePage).cullChunks, stage);
      pass.setBindGroup(0, groups.pages[index].cullChunks);
      pass.dispatchWorkgroups(...chunkWorkgroups(chunkCount));
    }
    scans.chunks.record(pass);
    this.#useOnce(pass, compactChunks);
    pass.dispatchWorkgroups(...chunkWorkgroups(totalChunks(pages)));
    this.#useOnce(pass, planCull);
    pass.dispatchWorkgroups(1);
    stage = null;
    for (const [index, framePage] of pages.entries()) {
      const { chunkCount } = framePage;
      const indirect = { buffer: buffers.cullDispatches, offset: 12 * index };
      const cut = stagesOf(shape, framePage).cutSplats;
      if (cut) {
        stage = this.#usePipeline(pass, cut, stage);
        pass.setBindGroup(0, groups.pages[index].cutSplats);
        dispatchWithin(pass, cutWorkgroups(chunkCount), shape, indirect);
      }
      stage = this.#usePipeline(pass, stagesOf(shape, framePage).cullSplats, stage);
      pass.setBindGroup(0, groups.pages[index].cullSplats);
      dispatchWithin(pass, chunkCount, shape, indirect);
    }
    scans.splats.record(pass);
    this.#useOnce(pass, compactSplats);
    const indirect = { buffer: buffers.cullDispatches, offset: 12 * pages.length };
    dispatchWithin(pass, totalChunks(pages), shape, indirect);
  }

  /** Records the stages that count splats per threshold, and choose a cut within the budget. */
  #recordBudget(
    pass: GPUComputePassEncoder,
    shape: FrameShape,
    pages: readonly FramePage[],
    plan: GPUBindGroup,
  ): void {
    let stage: StageDefinition | null = null;
    for (const [index, framePage] of pages.entries()) {
      const { cutCount } = stagesOf(shape, framePage);
      if (!cutCount) continue;
      stage = this.#usePipeline(pass, cutCount, stage);
      pass.setBindGroup(0, this.#groups!.pages[index].cutCount);
      const workgroups = countWorkgroups(framePage.chunkCount, shape.sortDevice);
      pass.dispatchWorkgroups(...dispatchSize(workgroups, shape.dispatchRow));
    }
    useCompute(pass, this.#context.pipelines, planCut, plan);
    pass.dispatchWorkgroups(1);
  }

  #useOnce(pass: GPUComputePassEncoder, stage: StageDefinition): void {
    useCompute(pass, this.#context.pipelines, stage, this.#groups!.frame.get(stage)!);
  }

  /** Sets the pipeline of `stage` unless it is `current`: most pages use the same. */
  #usePipeline(
    pass: GPUComputePassEncoder,
    stage: StageDefinition,
    current: StageDefinition | null,
  ): StageDefinition {
    if (stage !== current) pass.setPipeline(this.#context.pipelines.compute(stage)!);
    return stage;
  }

  #make(shape: FrameShape, pages: readonly FramePage[]): Held {
    const { device, pipelines } = this.#context;
    const memory = this.#memory;
    const chunkCount = totalChunks(pages);
    const buffers = {} as Record<BufferName, GPUBuffer>;
    const scan = (values: GPUBuffer, inputCount: GPUBuffer) => {
      const { label } = values;
      const options = { label, values, inputCount, maxCount: chunkCount, dispatchRow: shape.dispatchRow };
      return new PrefixScan(device, pipelines, memory, options);
    };
    const table = Object.entries(bufferTable(shape, pages));
    for (const [key, [bytes, usage]] of table) {
      const name = key as BufferName;
      const flags = usage | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
      buffers[name] = memory.createBuffer(`frame ${name}`, bytes, flags);
    }
    const scans = {
      chunks: scan(buffers.chunkOffsets, buffers.chunkCount),
      splats: scan(buffers.splatOffsets, buffers.slotCount),
    };
    writeConstants(device.queue, buffers, shape, pages);
    return { buffers, scans, shape };
  }
}

/** See `dispatchAtMost`. */
function dispatchWithin(
  pass: GPUComputePassEncoder,
  bound: number,
  { dispatchRow, sortDevice }: FrameShape,
  indirect: IndirectArguments,
): void {
  dispatchAtMost(pass, bound, dispatchRow, indirect, sortDevice.isNarrow);
}

/** Writes contents that last as long as the buffers: planes of all precisions share pages. */
function writeConstants(
  queue: GPUQueue,
  buffers: Buffers,
  { visibleCapacity, dispatchRow }: FrameShape,
  pages: readonly FramePage[],
): void {
  const chunkCount = totalChunks(pages);
  const counts = { chunkCount, pageCount: pages.length, visibleCapacity };
  const parameters = CullParameters.pack({ ...counts, dispatchRow });
  queue.writeBuffer(buffers.cullParameters, 0, parameters);
  queue.writeBuffer(buffers.chunkCount, 0, Uint32Array.of(chunkCount));
  const plans = new ArrayBuffer(PagePlan.bytes * pages.length);
  for (const [index, page] of pages.entries()) {
    const found = { slotStart: 0, slotCount: 0, visibleStart: 0, visibleCount: 0 };
    const chunks = { chunkStart: page.chunkStart, chunkEnd: page.chunkStart + page.chunkCount };
    PagePlan.write(plans, { ...chunks, ...found }, index * PagePlan.bytes);
  }
  if (plans.byteLength > 0) queue.writeBuffer(buffers.pagePlans, 0, plans);
}
