import { maxColor } from '../accuracy/accuracy.ts';
import type { CloudPage, CloudPages } from '../clouds/cloud-planes.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines } from '../gpu/pipelines.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { roundUp } from '../layout/gpu-struct.ts';
import { FrameParameters, HostDepth, Page, PagePlan, PROJECTED_SPLATS, View } from '../layout/structs.ts';
import { compactChunks } from '../stages/compact-chunks.ts';
import { compactSplats } from '../stages/compact-splats.ts';
import { cullChunks } from '../stages/cull-chunks.ts';
import { cullSplats } from '../stages/cull-splats.ts';
import { keepColors } from '../stages/keep-colors.ts';
import { planCull } from '../stages/plan-cull.ts';
import { planProject } from '../stages/plan-project.ts';
import { PrefixScan } from '../stages/prefix-scan.ts';
import { project } from '../stages/project.ts';
import { RadixSort } from '../stages/radix-sort.ts';
import { rasterize, rasterizeState } from '../stages/rasterize.ts';
import { sortShapeFor } from '../stages/sort-shape.ts';
import { upscale, upscaleState } from '../stages/upscale.ts';
import type { ColorCache } from './color-cache.ts';
import type { CloudInstance } from './frame-request.ts';
import type { FrameShape } from './frame-shape.ts';
import { SelectionBits } from './selection-bits.ts';

/** One page of one of the frame's clouds. */
export interface FramePage extends CloudPage {
  readonly cloudIndex: number;
  /** First chunk, counting through the frame. */
  readonly chunkStart: number;
}

interface FrameGroups {
  readonly planCull: GPUBindGroup;
  readonly compactChunks: GPUBindGroup;
  readonly planProject: GPUBindGroup;
  readonly compactSplats: GPUBindGroup;
  readonly rasterize: GPUBindGroup;
  readonly pages: readonly {
    readonly cullChunks: GPUBindGroup;
    readonly cullSplats: GPUBindGroup;
    readonly project: GPUBindGroup;
  }[];
}

/** Uniform buffers are bound at multiples of this many bytes. */
const UNIFORM_ALIGNMENT = 256;
export const PAGE_STRIDE_BYTES = roundUp(Page.bytes, UNIFORM_ALIGNMENT);

/** Names and sizes of a frame's buffers; stages are bound to them by these names. */
function bufferTable(shape: FrameShape, pageCount: number, chunkCount: number): BufferTable {
  const { STORAGE, UNIFORM, INDIRECT } = GPUBufferUsage;
  const record = PROJECTED_SPLATS[shape.accuracy.recordPrecision];
  return {
    view: [View.bytes, UNIFORM],
    pageUniforms: [PAGE_STRIDE_BYTES * pageCount, UNIFORM],
    frame: [FrameParameters.bytes, UNIFORM],
    chunkCount: [4, STORAGE],
    /** Per chunk 1 where it is visible, then the number of visible chunks before it. */
    chunkOffsets: [4 * (chunkCount + 1), STORAGE],
    visibleChunks: [4 * chunkCount, STORAGE],
    /** Number of visible chunks: their slots are numbered in storage order. */
    slotCount: [4, STORAGE],
    /** Per slot a bit per splat. */
    visibilityMasks: [(CHUNK_SPLATS / 8) * chunkCount, STORAGE],
    /** Per slot its number of visible splats, then the number of them before it. */
    splatOffsets: [4 * (chunkCount + 1), STORAGE],
    // A binding holds at least one element, also where there is nothing to draw.
    pagePlans: [PagePlan.bytes * Math.max(1, pageCount), STORAGE],
    depthRange: [8, STORAGE | UNIFORM],
    visibleCount: [4, STORAGE],
    cullDispatches: [12 * (pageCount + 1), STORAGE | INDIRECT],
    projectDispatches: [12 * pageCount, STORAGE | INDIRECT],
    drawArguments: [16, STORAGE | INDIRECT],
    /** The visible splats in storage order. */
    survivors: [4 * shape.visibleCapacity, STORAGE],
    projected: [record.bytes * Math.max(1, shape.visibleCapacity), STORAGE],
  };
}

type BufferName =
  | 'view'
  | 'pageUniforms'
  | 'frame'
  | 'chunkCount'
  | 'chunkOffsets'
  | 'visibleChunks'
  | 'slotCount'
  | 'visibilityMasks'
  | 'splatOffsets'
  | 'pagePlans'
  | 'depthRange'
  | 'visibleCount'
  | 'cullDispatches'
  | 'projectDispatches'
  | 'drawArguments'
  | 'survivors'
  | 'projected';
type BufferTable = Readonly<Record<BufferName, readonly [bytes: number, usage: GPUBufferUsageFlags]>>;

/** The buffers and bind groups of one view of some clouds. Only frame.ts runs stages on them. */
export class FrameResources {
  /** Chunks of all pages. */
  readonly chunkCount: number;
  /** Splats of all clouds. */
  readonly totalSplats: number;
  readonly buffers = {} as Record<BufferName, GPUBuffer>;
  /** One `HostDepth`, for shapes with depth. */
  readonly hostDepth: GPUBuffer | null = null;
  /** Parameters of the clouds' effects, `effectsStrideBytes` apart; null where there are none. */
  #effects: GPUBuffer | null = null;
  readonly #selections: SelectionBits;
  readonly chunkScan: PrefixScan;
  readonly splatScan: PrefixScan;
  readonly sort: RadixSort;
  readonly #colors: ColorCache;
  #shape: FrameShape;
  #pages: readonly FramePage[];
  #groups: FrameGroups;
  readonly #pipelines: Pipelines;
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;

  /**
   * @param colors of the view, which outlive these buffers.
   * @throws GpuLimitError where a buffer would pass the device's limits; nothing stays allocated then.
   */
  constructor(
    device: GPUDevice,
    pipelines: Pipelines,
    memory: GpuMemory,
    shape: FrameShape,
    colors: ColorCache,
  ) {
    this.#shape = shape;
    this.#pipelines = pipelines;
    this.#memory = memory;
    this.#queue = device.queue;
    this.#colors = colors;
    this.#selections = new SelectionBits(memory, device.queue);
    this.#pages = pagesOf(shape.planes);
    this.chunkCount = this.pages.reduce((sum, page) => sum + page.chunkCount, 0);
    this.totalSplats = shape.clouds.reduce((sum, cloud) => sum + cloud.count, 0);
    const { dispatchRow } = shape;
    const { buffers, chunkCount } = this;
    try {
      const table = bufferTable(shape, this.pages.length, chunkCount);
      for (const [name, [bytes, usage]] of Object.entries(table)) {
        const flags = usage | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
        buffers[name as BufferName] = memory.createBuffer(`frame ${name}`, bytes, flags);
      }
      if (shape.depth) {
        const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
        this.hostDepth = memory.createBuffer('frame hostDepth', HostDepth.bytes, usage);
      }
      const scan = (values: GPUBuffer, inputCount: GPUBuffer) =>
        new PrefixScan(device, pipelines, memory, {
          label: values.label,
          values,
          inputCount,
          maxCount: chunkCount,
          dispatchRow,
        });
      this.chunkScan = scan(buffers.chunkOffsets, buffers.chunkCount);
      this.splatScan = scan(buffers.splatOffsets, buffers.slotCount);
      this.sort = new RadixSort(device, pipelines, memory, {
        shape: sortShapeFor(shape.keyBits),
        capacity: shape.visibleCapacity,
        keyCount: buffers.visibleCount,
        dispatchRow,
      });
      this.#makeEffects();
      this.#writeConstants();
      this.#groups = this.#bind();
    } catch (error) {
      this.destroy();
      throw error;
    }
  }

  get shape(): FrameShape {
    return this.#shape;
  }

  get pages(): readonly FramePage[] {
    return this.#pages;
  }

  get groups(): FrameGroups {
    return this.#groups;
  }

  /** Of one cloud's parameters to the next one's in what `writeEffects` takes. */
  get effectsStrideBytes(): number {
    return effectsStride(this.#shape);
  }

  /** Goes over to another shape that `hasSameBuffers`: other shaders, other planes of the same clouds. */
  reshape(shape: FrameShape): void {
    this.#shape = shape;
    this.#pages = pagesOf(shape.planes);
    this.#makeEffects();
    this.#groups = this.#bind();
  }

  /** @param view one `View`; @param pages a `Page` per page, PAGE_STRIDE_BYTES apart. */
  writeUniforms(view: ArrayBuffer, pages: ArrayBuffer): void {
    this.#queue.writeBuffer(this.buffers.view, 0, view);
    this.#queue.writeBuffer(this.buffers.pageUniforms, 0, pages);
  }

  /** @param contents one `HostDepth`, for shapes with depth. */
  writeHostDepth(contents: ArrayBuffer): void {
    if (this.hostDepth) this.#queue.writeBuffer(this.hostDepth, 0, contents);
  }

  /** @param contents parameters per cloud, `effectsStrideBytes` apart; for shapes with such. */
  writeEffects(contents: ArrayBuffer): void {
    if (this.#effects) this.#queue.writeBuffer(this.#effects, 0, contents);
  }

  /** @param clouds of the frame, for shapes with effects that are told what is selected of them. */
  writeSelections(clouds: readonly CloudInstance[]): void {
    this.#selections.write(clouds);
  }

  /** Of what one cloud's effects are told of what is selected. */
  selectionBytes(cloudIndex: number): number {
    return this.#selections.bytesOf(cloudIndex);
  }

  /** For taking one page's colours from the records. */
  keepColorsGroup(pageIndex: number): GPUBindGroup {
    const { buffers, shape } = this;
    const page = { buffer: buffers.pageUniforms, offset: pageIndex * PAGE_STRIDE_BYTES, size: Page.bytes };
    const keptColors = this.#colors.bufferOf(pageIndex, this.pages[pageIndex], shape.accuracy);
    return this.#pipelines.bindGroup(keepColorsStage(shape), { ...buffers, page, keptColors });
  }

  destroy(): void {
    this.#selections.destroy();
    if (this.#effects) this.#memory.destroy(this.#effects);
    this.chunkScan?.destroy();
    this.splatScan?.destroy();
    this.sort?.destroy();
    for (const buffer of Object.values(this.buffers)) this.#memory.destroy(buffer);
    if (this.hostDepth) this.#memory.destroy(this.hostDepth);
  }

  /** Room for what the shape's effects take, where what there is does not fit. */
  #makeEffects(): void {
    this.#selections.reshape(this.#shape, this.#pages);
    const bytes = effectsStride(this.#shape) * this.#shape.clouds.length;
    if ((this.#effects?.size ?? 0) === bytes) return;
    if (this.#effects) this.#memory.destroy(this.#effects);
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.#effects = bytes > 0 ? this.#memory.createBuffer('frame effects', bytes, usage) : null;
  }

  #writeConstants(): void {
    const { buffers, chunkCount, pages } = this;
    const parameters = new ArrayBuffer(FrameParameters.bytes);
    FrameParameters.write(parameters, {
      chunkCount,
      pageCount: pages.length,
      dispatchRow: this.shape.dispatchRow,
    });
    this.#queue.writeBuffer(buffers.frame, 0, parameters);
    this.#queue.writeBuffer(buffers.chunkCount, 0, Uint32Array.of(chunkCount));
    const plans = new ArrayBuffer(PagePlan.bytes * pages.length);
    for (const [index, page] of pages.entries()) {
      const found = { slotStart: 0, slotCount: 0, survivorStart: 0, survivorCount: 0 };
      const chunks = { chunkStart: page.chunkStart, chunkEnd: page.chunkStart + page.chunkCount };
      PagePlan.write(plans, { ...chunks, ...found }, index * PagePlan.bytes);
    }
    this.#queue.writeBuffer(buffers.pagePlans, 0, plans);
  }

  #bind(): FrameGroups {
    const { buffers, sort, shape } = this;
    const stride = effectsStride(shape);
    const pipelines = this.#pipelines;
    return {
      planCull: pipelines.bindGroup(planCull, buffers),
      compactChunks: pipelines.bindGroup(compactChunks, buffers),
      planProject: pipelines.bindGroup(planProject, buffers),
      compactSplats: pipelines.bindGroup(compactSplats, buffers),
      rasterize: pipelines.bindGroup(rasterizeStage(shape)[0], {
        ...buffers,
        order: sort.order,
        ...(this.hostDepth && { hostDepth: this.hostDepth }),
      }),
      pages: this.pages.map((framePage, index) => {
        const { chunks, geometry, shRest, cloudIndex } = framePage;
        const keptColors = shape.keepsColors[cloudIndex]
          ? this.#colors.bufferOf(index, framePage, shape.accuracy)
          : null;
        const page = { buffer: buffers.pageUniforms, offset: index * PAGE_STRIDE_BYTES, size: Page.bytes };
        const parameters = this.#effects && {
          buffer: this.#effects,
          offset: cloudIndex * stride,
          size: stride,
        };
        const selectedBits = this.#selections.bindingOf(index);
        const own = {
          ...buffers,
          page,
          chunks,
          geometry,
          keys: sort.keys,
          ...(shRest && { shRest }),
          ...(parameters && { effects: parameters }),
          ...(selectedBits && { selectedBits }),
          ...(keptColors && { keptColors }),
        };
        return {
          cullChunks: pipelines.bindGroup(cullChunks, own),
          cullSplats: pipelines.bindGroup(cullSplatsStage(shape, cloudIndex), own),
          project: pipelines.bindGroup(projectStage(shape, cloudIndex), own),
        };
      }),
    };
  }
}

/** The stage that culls the splats of one of the frame's clouds. */
export function cullSplatsStage(
  { isOrthographic, accuracy, planes, effects, isIsotropic, hasFaintSplats }: FrameShape,
  cloudIndex: number,
) {
  const { geometryPrecision } = planes[cloudIndex];
  const { extent, culling } = accuracy;
  return cullSplats({
    isOrthographic,
    geometryPrecision,
    extent,
    culling,
    effects: effects[cloudIndex],
    isIsotropic: isIsotropic[cloudIndex],
    hasFaintSplats: hasFaintSplats[cloudIndex],
  });
}

/** The stage that projects the splats of one of the frame's clouds. */
export function projectStage(shape: FrameShape, cloudIndex: number) {
  const { isOrthographic, accuracy, shortensKeys, clouds, planes, shDegrees } = shape;
  const { geometryPrecision, shPrecision } = planes[cloudIndex];
  const { shDegree } = clouds[cloudIndex];
  return project({
    isOrthographic,
    geometryPrecision,
    recordPrecision: accuracy.recordPrecision,
    shPrecision,
    shortKeyBits: shortensKeys ? accuracy.sortKeyBits : null,
    maxColor: maxColor(accuracy),
    storedShDegree: shDegree,
    shDegree: shDegrees[cloudIndex],
    effects: shape.effects[cloudIndex],
    keepsColors: shape.keepsColors[cloudIndex],
    isIsotropic: shape.isIsotropic[cloudIndex],
  });
}

/** The stage that keeps the colours of what was drawn last. */
export function keepColorsStage({ accuracy }: FrameShape) {
  return keepColors(accuracy.recordPrecision);
}

/** The stage that draws the visible splats, and what it draws into. */
export function rasterizeStage({ accuracy, depth }: FrameShape) {
  const { recordPrecision, extent, colorTarget } = accuracy;
  return [rasterize({ recordPrecision, extent, depth }), rasterizeState(colorTarget, depth)] as const;
}

/** The stage that brings what `rasterizeStage` has drawn to the picture's size, and what it draws into. */
export function upscaleStage({ accuracy, depth }: FrameShape) {
  const depthFormat = depth?.layerFormat ?? null;
  return [upscale(depthFormat !== null), upscaleState(accuracy.colorTarget, depthFormat)] as const;
}

/** Bytes from one cloud's effect parameters to the next one's; 0 where no cloud has any. */
export function effectsStride({ effects }: FrameShape): number {
  return roundUp(Math.max(0, ...effects.map(({ parameterBytes }) => parameterBytes)), UNIFORM_ALIGNMENT);
}

function pagesOf(planes: readonly CloudPages[]): FramePage[] {
  let chunkStart = 0;
  return planes.flatMap(({ pages }, cloudIndex) =>
    pages.map((page) => {
      const framePage = { ...page, cloudIndex, chunkStart };
      chunkStart += page.chunkCount;
      return framePage;
    }),
  );
}

/** Cloud and place in its storage order of splat `number`, which counts through all chunks of the frame. */
export function locateSplat(
  pages: readonly FramePage[],
  number: number,
): { readonly cloudIndex: number; readonly storedIndex: number } {
  const chunk = Math.floor(number / CHUNK_SPLATS);
  const { cloudIndex } = pages.findLast(({ chunkStart }) => chunkStart <= chunk)!;
  // Only the last page of a cloud has a chunk that is not full: its pages are one run of splats.
  const { chunkStart } = pages.find((page) => page.cloudIndex === cloudIndex)!;
  return { cloudIndex, storedIndex: number - CHUNK_SPLATS * chunkStart };
}
