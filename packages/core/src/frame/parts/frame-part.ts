import type { Vec3 } from '../../data/math/mat4.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings, Pipelines } from '../../gpu/pipelines.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import type { FrameShape } from '../plan/frame-shape.ts';

/** Buffers of a frame, by the names that `frame-passes.ts` lists for its stages. */
export interface FrameBuffers {
  readonly view: GPUBuffer;
  readonly pageUniforms: GPUBuffer;
  readonly cullParameters: GPUBuffer;
  readonly chunkOffsets: GPUBuffer;
  readonly visibleChunks: GPUBuffer;
  readonly slotCount: GPUBuffer;
  readonly visibilityMasks: GPUBuffer;
  readonly splatOffsets: GPUBuffer;
  readonly pagePlans: GPUBuffer;
  readonly depthRange: GPUBuffer;
  readonly cullDispatches: GPUBuffer;
  readonly visibleSplats: GPUBuffer;
  /** Number of visible splats. */
  readonly visibleCount: GPUBuffer;
  /** Dispatches of project by page, then of tile-count. */
  readonly projectDispatches: GPUBuffer;
  readonly drawArguments: GPUBuffer;
  readonly records: GPUBuffer;
  /** One `SortPlan` of the sort by depth, and the dispatch over its blocks. */
  readonly depthSortPlan: GPUBuffer;
  readonly depthSortDispatch: GPUBuffer;
  /**
   * Keys of the visible splats, or the lower words of wide keys. After the sort, tile lists use it as
   * scratch memory of a word per splat.
   */
  readonly keys: GPUBuffer;
  /** The visible splats back to front, after the sort. */
  readonly order: GPUBuffer;
  /** One `TileGrid`; this and the buffers below only for shapes with tiles. */
  readonly grid: GPUBuffer;
  readonly tilePlan: GPUBuffer;
  readonly pairDispatches: GPUBuffer;
  readonly binStarts: GPUBuffer;
  readonly binOrder: GPUBuffer;
  readonly tileMasks: GPUBuffer;
  /** Records of the pairs, by bin and front to back. */
  readonly sortedRecords: GPUBuffer;
}

/** Buffers and textures of frames of some shapes; null, or of an earlier frame, for others. */
interface OptionalResources {
  /** One `CutPlan`, for frames with a budget. */
  readonly cutPlan: GPUBuffer | null;
  /** One `HostDepth`, for shapes with depth. */
  readonly hostDepth: GPUBuffer | null;
  /** The host's depth at the size of `layer`. */
  readonly testedDepth: GPUTexture | null;
  /** The layer that splats are blended in, of the image's size or smaller: see `LayerTextures`. */
  readonly layer: GPUTexture;
  readonly depthLayer: GPUTexture | null;
  /** The blended splats at the image's size: `layer` itself if nothing is enlarged. */
  readonly image: GPUTexture;
  readonly depthImage: GPUTexture | null;
  /** The splats over the host's image. */
  readonly composed: GPUTexture;
}

/** Resources of a frame by name; those that only stages bind have no type. */
export type FrameResources = Bindings & FrameBuffers & Partial<OptionalResources>;

/** Stages run once for each page, or for each batch of a cloud that is cut. */
export interface StageTarget {
  readonly cloudIndex: number;
  /** Whether it is a page of merged splats. */
  readonly isBlobs: boolean;
  /** Its chunks, or the cells of its cuts. */
  readonly count: number;
  readonly resources: Bindings;
  /** Whatever its cloud's effects bind; undefined without any. */
  readonly effects?: Bindings;
}

/** GPU memory that parts share: each publishes its own under names that no other uses. */
export class SharedMemory {
  readonly resources = {} as { -readonly [Name in keyof FrameResources]: FrameResources[Name] };
  /** The frame's pages, and its batches of cuts, with what stages bind there. */
  pages: readonly StageTarget[] = [];
  batches: readonly StageTarget[] = [];
}

export interface PartContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  /** Freed as a whole when the parts end. */
  readonly memory: GpuMemory;
  readonly shared: SharedMemory;
  /** Most bytes that the tiles' own buffers may take. */
  readonly tileBudgetBytes: number;
}

/** A change of a part's buffers and textures that the device's limits allow. */
export interface PartChange {
  /** Frees the replaced memory. All parts free before any makes: old and new never coexist. */
  free(): void;
  /** Makes the new memory. Fails only for lack of memory, and ends all parts then. */
  make(): void;
}

/** The host's textures behind the splats, between two of its passes. */
export interface HostPass {
  /** Linear light, premultiplied, one sample; with usage TEXTURE_BINDING, or at least COPY_SRC. */
  readonly color: GPUTexture;
  /** One or several samples, with usage TEXTURE_BINDING; null if the host has no depth. */
  readonly depth: GPUTexture | null;
  /** Top left of the viewport within both textures, in pixels. */
  readonly xPx: number;
  readonly yPx: number;
  /** Layer to use of array textures, e.g. a cube's face; default 0. */
  readonly layer?: number;
  /**
   * Whether the view writes its image into `color`, which needs the format rgba16float and usage
   * COPY_DST. If so, the image has the host's colours where there is no splat, and the host does not
   * show it. Default: false.
   */
  readonly writesColor?: boolean;
}

/** Target of one frame; `kind` equals the shape's `output`. */
export type Destination =
  | { readonly kind: 'image' }
  | { readonly kind: 'canvas'; readonly canvas: GPUCanvasContext; readonly background: Vec3 }
  | { readonly kind: 'host'; readonly pass: HostPass };

/** A part of the quads to draw only to be timed. */
export interface QuadsSample {
  /** Part of the visible splats, 0…1. */
  readonly share: number;
  /** Number of visible splats of a recent frame. */
  readonly visibleSplats: number;
}

/** How the visible splats of a frame are drawn. */
export interface Drawing {
  readonly shape: FrameShape;
  readonly destination: Destination;
  /** Null for no sample. Only in frames that tiles draw: they overwrite it. */
  readonly sample: QuadsSample | null;
}

/** GPU memory and uniforms of some of a frame's stages: nothing for shapes that do not run them. */
export interface FramePart {
  /**
   * Returns the change that gives the part the memory that `plan` needs; null if it has that memory
   * already.
   *
   * @throws GpuLimitError if a buffer would exceed the device's limits.
   */
  fit?(plan: FramePlan): PartChange | null;
  /** Publishes what depends on the shape alone, after the changes of all parts. */
  bind?(shape: FrameShape): void;
  /** Writes everything that changes from frame to frame. */
  write?(plan: FramePlan): void;
  /** Publishes and writes what depends on the destination of a drawing. @throws GpuLimitError */
  aim?(drawing: Drawing): void;
}

/** Creates the buffers of a part, labelled `prefix` and name. They can be copied from and to. */
export function createBuffers<Name extends string>(
  memory: GpuMemory,
  prefix: string,
  table: Readonly<Record<Name, readonly [bytes: number, usage: GPUBufferUsageFlags]>>,
): Record<Name, GPUBuffer> {
  const { COPY_DST, COPY_SRC } = GPUBufferUsage;
  const buffers = {} as Record<Name, GPUBuffer>;
  for (const name of Object.keys(table) as Name[]) {
    const [bytes, usage] = table[name];
    buffers[name] = memory.createBuffer(`${prefix} ${name}`, bytes, usage | COPY_DST | COPY_SRC);
  }
  return buffers;
}
