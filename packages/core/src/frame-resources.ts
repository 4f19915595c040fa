import type { AccuracySettings } from './accuracy.ts';
import type { GpuMemory } from './gpu/gpu-memory.ts';
import type { Pipelines } from './gpu/pipelines.ts';
import { CHUNK_SPLATS } from './layout/constants.ts';
import { roundUp } from './layout/gpu-struct.ts';
import {
  FrameParameters,
  Page,
  PagePlan,
  ProjectedSplat,
  ProjectedSplatF32,
  View,
} from './layout/structs.ts';
import type { CloudPage, SplatCloud } from './scene/splat-cloud.ts';
import type { ShDegree } from './scene/splat-set.ts';
import { compactChunks } from './stages/compact-chunks.ts';
import { compactSplats } from './stages/compact-splats.ts';
import { cullChunks } from './stages/cull-chunks.ts';
import { cullSplats } from './stages/cull-splats.ts';
import { planCull } from './stages/plan-cull.ts';
import { planProject } from './stages/plan-project.ts';
import { PrefixScan } from './stages/prefix-scan.ts';
import { project } from './stages/project.ts';
import { RadixSort, sortShapeFor } from './stages/radix-sort.ts';
import { rasterize } from './stages/rasterize.ts';

/** Everything that decides which shaders a frame runs and how large its buffers are. */
export interface FrameShape {
  /** In the order in which equal depths are drawn; a cloud may occur more than once. */
  readonly clouds: readonly SplatCloud[];
  readonly isOrthographic: boolean;
  readonly accuracy: AccuracySettings;
  /** Most workgroups in one dimension of a dispatch. */
  readonly dispatchRow: number;
  /** Bits that the depth keys of this frame may differ in, at most 32. */
  readonly keyBits: number;
}

/** One page of one of the frame's clouds. */
export interface FramePage extends CloudPage {
  readonly cloudIndex: number;
  /** First chunk, counting through the frame. */
  readonly chunkStart: number;
}

interface PageGroups {
  readonly cullChunks: GPUBindGroup;
  readonly cullSplats: GPUBindGroup;
  readonly project: GPUBindGroup;
}

/** Uniform buffers are bound at multiples of this many bytes. */
export const PAGE_STRIDE_BYTES = roundUp(Page.bytes, 256);

/** The buffers and bind groups of one view of some clouds. Only frame.ts runs stages on them. */
export class FrameResources {
  readonly shape: FrameShape;
  readonly pages: readonly FramePage[];
  readonly totalSplats: number;
  /** Visible chunks. */
  readonly slotCount: GPUBuffer;
  readonly visibleCount: GPUBuffer;
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  readonly #buffers: GPUBuffer[] = [];
  readonly chunkCount: number;
  readonly #view: GPUBuffer;
  readonly #pageUniforms: GPUBuffer;
  readonly cullDispatches: GPUBuffer;
  readonly projectDispatches: GPUBuffer;
  readonly drawArguments: GPUBuffer;
  readonly chunkScan: PrefixScan;
  readonly splatScan: PrefixScan;
  readonly sort: RadixSort;
  readonly groups: {
    readonly planCull: GPUBindGroup;
    readonly compactChunks: GPUBindGroup;
    readonly planProject: GPUBindGroup;
    readonly compactSplats: GPUBindGroup;
    readonly rasterize: GPUBindGroup;
    readonly pages: readonly PageGroups[];
  };

  /** @throws GpuLimitError where a buffer would pass the device's limits; nothing stays allocated. */
  constructor(device: GPUDevice, pipelines: Pipelines, memory: GpuMemory, shape: FrameShape) {
    this.shape = shape;
    this.#memory = memory;
    this.#queue = device.queue;
    this.pages = pagesOf(shape.clouds);
    this.chunkCount = this.pages.reduce((sum, page) => sum + page.chunkCount, 0);
    this.totalSplats = shape.clouds.reduce((sum, cloud) => sum + cloud.count, 0);
    const { STORAGE, UNIFORM, INDIRECT } = GPUBufferUsage;
    const record = shape.accuracy.recordPrecision === 'f32' ? ProjectedSplatF32 : ProjectedSplat;
    const pageCount = this.pages.length;
    try {
      this.#view = this.#buffer('view', View.bytes, UNIFORM);
      this.#pageUniforms = this.#buffer('pages', PAGE_STRIDE_BYTES * pageCount, UNIFORM);
      const frame = this.#buffer('frame parameters', FrameParameters.bytes, UNIFORM);
      const chunkCount = this.#buffer('chunk count', 4, STORAGE);
      const chunkOffsets = this.#buffer('chunk offsets', 4 * (this.chunkCount + 1), STORAGE);
      const visibleChunks = this.#buffer('visible chunks', 4 * this.chunkCount, STORAGE);
      const visibilityMasks = this.#buffer('visibility masks', (CHUNK_SPLATS / 8) * this.chunkCount, STORAGE);
      const splatOffsets = this.#buffer('splat offsets', 4 * (this.chunkCount + 1), STORAGE);
      const pagePlans = this.#buffer('page plans', PagePlan.bytes * pageCount, STORAGE);
      const depthRange = this.#buffer('depth range', 8, STORAGE);
      const survivors = this.#buffer('visible splats', 4 * this.totalSplats, STORAGE);
      const projected = this.#buffer('projected splats', record.bytes * this.totalSplats, STORAGE);
      this.slotCount = this.#buffer('visible chunk count', 4, STORAGE);
      this.visibleCount = this.#buffer('visible splat count', 4, STORAGE);
      this.cullDispatches = this.#buffer('cull dispatches', 12 * (pageCount + 1), STORAGE | INDIRECT);
      this.projectDispatches = this.#buffer('project dispatches', 12 * pageCount, STORAGE | INDIRECT);
      this.drawArguments = this.#buffer('draw arguments', 16, STORAGE | INDIRECT);

      const { dispatchRow } = shape;
      this.chunkScan = new PrefixScan(device, pipelines, memory, {
        label: 'chunks',
        values: chunkOffsets,
        inputCount: chunkCount,
        maxCount: this.chunkCount,
        dispatchRow,
      });
      this.splatScan = new PrefixScan(device, pipelines, memory, {
        label: 'splats',
        values: splatOffsets,
        inputCount: this.slotCount,
        maxCount: this.chunkCount,
        dispatchRow,
      });
      this.sort = new RadixSort(device, pipelines, memory, {
        shape: sortShapeFor(shape.keyBits),
        capacity: this.totalSplats,
        keyCount: this.visibleCount,
        dispatchRow,
      });

      const parameters = new ArrayBuffer(FrameParameters.bytes);
      FrameParameters.write(parameters, { chunkCount: this.chunkCount, pageCount, dispatchRow });
      device.queue.writeBuffer(frame, 0, parameters);
      device.queue.writeBuffer(chunkCount, 0, Uint32Array.of(this.chunkCount));
      this.#writePagePlans(pagePlans);

      this.groups = {
        planCull: pipelines.bindGroup(planCull, {
          frame,
          chunkOffsets,
          pagePlans,
          slotCount: this.slotCount,
          cullDispatches: this.cullDispatches,
          depthRange,
        }),
        compactChunks: pipelines.bindGroup(compactChunks, { frame, chunkOffsets, visibleChunks }),
        planProject: pipelines.bindGroup(planProject, {
          frame,
          splatOffsets,
          slotCount: this.slotCount,
          pagePlans,
          visibleCount: this.visibleCount,
          projectDispatches: this.projectDispatches,
          drawArguments: this.drawArguments,
        }),
        compactSplats: pipelines.bindGroup(compactSplats, {
          frame,
          chunkOffsets,
          visibleChunks,
          visibilityMasks,
          splatOffsets,
          survivors,
        }),
        rasterize: pipelines.bindGroup(rasterize(shape.accuracy.recordPrecision), {
          view: this.#view,
          order: this.sort.order,
          projected,
        }),
        pages: this.pages.map(({ chunks, geometry, shRest, cloudIndex }, index) => {
          const view = this.#view;
          const page = { buffer: this.#pageUniforms, offset: index * PAGE_STRIDE_BYTES, size: Page.bytes };
          return {
            cullChunks: pipelines.bindGroup(cullChunks, { view, page, chunks, chunkOffsets }),
            cullSplats: pipelines.bindGroup(cullSplatsStage(shape), {
              view,
              page,
              pagePlans,
              visibleChunks,
              geometry,
              visibilityMasks,
              splatOffsets,
              depthRange,
            }),
            project: pipelines.bindGroup(projectStage(shape, shape.clouds[cloudIndex]), {
              view,
              page,
              pagePlans,
              survivors,
              depthRange,
              geometry,
              projected,
              keys: this.sort.keys,
              ...(shRest ? { shRest } : {}),
            }),
          };
        }),
      };
    } catch (error) {
      this.destroy();
      throw error;
    }
  }

  /** @param view one `View`; @param pages a `Page` per page, PAGE_STRIDE_BYTES apart. */
  writeUniforms(view: ArrayBuffer, pages: ArrayBuffer): void {
    this.#queue.writeBuffer(this.#view, 0, view);
    this.#queue.writeBuffer(this.#pageUniforms, 0, pages);
  }

  destroy(): void {
    this.chunkScan?.destroy();
    this.splatScan?.destroy();
    this.sort?.destroy();
    for (const buffer of this.#buffers) this.#memory.destroy(buffer);
    this.#buffers.length = 0;
  }

  #writePagePlans(target: GPUBuffer): void {
    const plans = new ArrayBuffer(PagePlan.bytes * this.pages.length);
    for (const [index, { chunkStart, chunkCount }] of this.pages.entries()) {
      const found = { slotStart: 0, slotCount: 0, survivorStart: 0, survivorCount: 0 };
      PagePlan.write(
        plans,
        { chunkStart, chunkEnd: chunkStart + chunkCount, ...found },
        index * PagePlan.bytes,
      );
    }
    this.#queue.writeBuffer(target, 0, plans);
  }

  #buffer(label: string, bytes: number, usage: GPUBufferUsageFlags): GPUBuffer {
    const buffer = this.#memory.createBuffer(
      label,
      bytes,
      usage | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC,
    );
    this.#buffers.push(buffer);
    return buffer;
  }
}

/** The stage that culls the splats of any page of the frame. */
export function cullSplatsStage({ isOrthographic, accuracy }: FrameShape) {
  return cullSplats(isOrthographic, accuracy.geometryPrecision);
}

/** The stage that projects the splats of `cloud`. */
export function projectStage({ isOrthographic, accuracy }: FrameShape, cloud: SplatCloud) {
  return project({
    isOrthographic,
    geometryPrecision: accuracy.geometryPrecision,
    recordPrecision: accuracy.recordPrecision,
    shPrecision: cloud.shPrecision,
    storedShDegree: cloud.shDegree,
    shDegree: Math.min(accuracy.shDegree, cloud.shDegree) as ShDegree,
  });
}

function pagesOf(clouds: readonly SplatCloud[]): FramePage[] {
  let chunkStart = 0;
  return clouds.flatMap((cloud, cloudIndex) =>
    cloud.pages.map((page) => {
      const framePage = { ...page, cloudIndex, chunkStart };
      chunkStart += page.chunkCount;
      return framePage;
    }),
  );
}
