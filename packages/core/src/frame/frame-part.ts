import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { DispatchSize, RenderPass } from '../gpu/passes.ts';
import type { Bindings, Pipelines } from '../gpu/pipelines.ts';
import type { FramePlan } from './frame-plan.ts';
import type { FrameShape } from './frame-shape.ts';

/** Buffers that one part owns and stages of other parts bind, most of them by the same name. */
export interface SharedBuffers {
  readonly view: GPUBuffer;
  readonly pageUniforms: GPUBuffer;
  readonly records: GPUBuffer;
  /** Number of visible splats. */
  readonly visibleCount: GPUBuffer;
  /** One `SortPlan` of the sort by depth, and the dispatch over its blocks. */
  readonly depthSortPlan: GPUBuffer;
  readonly depthSortDispatch: GPUBuffer;
  /**
   * Keys of the visible splats, or the lower words of wide keys. After the sort, tile lists use it as
   * scratch memory of a word per splat.
   */
  readonly keys: GPUBuffer;
  /** Upper words of wide keys; only for shapes with such keys. */
  readonly upperKeys: GPUBuffer;
  /** The visible splats back to front, after the sort. */
  readonly order: GPUBuffer;
  readonly drawArguments: GPUBuffer;
  /** One `TileGrid` and one `TilePlan`; these and the buffers below only for shapes with tiles. */
  readonly tileGrid: GPUBuffer;
  readonly tilePlan: GPUBuffer;
  readonly binStarts: GPUBuffer;
  readonly binOrder: GPUBuffer;
  readonly tileMasks: GPUBuffer;
  /** Records of the pairs, by bin and front to back. */
  readonly sortedRecords: GPUBuffer;
  /** The buffers from here to `cullDispatches` are used by culling alone. */
  readonly cullParameters: GPUBuffer;
  readonly chunkOffsets: GPUBuffer;
  readonly visibleChunks: GPUBuffer;
  readonly slotCount: GPUBuffer;
  readonly visibilityMasks: GPUBuffer;
  readonly splatOffsets: GPUBuffer;
  readonly pagePlans: GPUBuffer;
  readonly depthRange: GPUBuffer;
  readonly cullDispatches: GPUBuffer;
  /** Dispatches of project by page, then of tile-count. */
  readonly projectDispatches: GPUBuffer;
  readonly visibleSplats: GPUBuffer;
}

/** Textures that splats are blended in, or that blended splats are enlarged into. */
export interface LayerTextures {
  /** Premultiplied RGBA in the space that splats are blended in. */
  readonly color: GPUTexture;
  /** View depth weighted like the colours; null if the shape does not need it. */
  readonly depthLayer: GPUTexture | null;
}

/** GPU memory that parts share: each publishes its own, and reads others' to bind and draw. */
export class SharedMemory {
  /** A new object whenever one of them is replaced. */
  buffers = {} as { -readonly [Name in keyof SharedBuffers]: SharedBuffers[Name] };
  /** By page of the frame: bindings of the stages that run over it. */
  pages: readonly Bindings[] = [];
  /** One `HostDepth`, for shapes with depth. */
  hostDepth: GPUBuffer | null = null;
  /** One `HostViewport`, for frames inside another renderer's frame. */
  viewport: GPUBuffer | null = null;
  /** The layer that splats are blended in: of the image's size, or smaller. */
  blended: LayerTextures | null = null;
  /** The blended splats at the image's size. */
  image: LayerTextures | null = null;
  /** The host's depth at the size of `blended`. */
  testedDepth: GPUTexture | null = null;
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

/**
 * A group of a frame's stages with the GPU memory that they need. A part that a shape does not use
 * runs no stages and holds nothing. Its class lists its stages, which are known before a part is
 * made. Only frame.ts orders parts.
 */
export interface FramePart {
  /**
   * Returns the change that gives the part the memory that `plan` needs; null if it has that memory
   * already.
   *
   * @throws GpuLimitError if a buffer would exceed the device's limits.
   */
  fit?(plan: FramePlan): PartChange | null;
  /** Binds the stages of `shape`, after the changes of all parts. */
  bind?(shape: FrameShape): void;
  /** Writes everything that changes from frame to frame. */
  write?(plan: FramePlan): void;
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

/** Size of a dispatch with a thread for each pixel of `image`. */
export function sizeOverImage(image: GPUTexture): DispatchSize {
  const tiles = (px: number) => Math.ceil(px / SHADER_CONSTANTS.IMAGE_TILE_PX);
  return [tiles(image.width), tiles(image.height), 1];
}

/** One triangle over the whole target. */
export const OVER_ALL: RenderPass['draws'] = [[3]];
