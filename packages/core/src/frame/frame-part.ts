import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { CompiledStage, Pipelines, RenderState, StageDefinition } from '../gpu/pipelines.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { GpuTimer } from '../timing/gpu-timer.ts';
import type { FramePlan } from './frame-plan.ts';
import type { FrameShape } from './frame-shape.ts';

/** Buffers that one part holds and stages of others bind, by the names that the stages give them. */
export interface SharedBuffers {
  readonly view: GPUBuffer;
  readonly pageUniforms: GPUBuffer;
  readonly pagePlans: GPUBuffer;
  readonly depthRange: GPUBuffer;
  readonly slotCount: GPUBuffer;
  readonly projectDispatches: GPUBuffer;
  readonly visibleSplats: GPUBuffer;
  readonly records: GPUBuffer;
  /** How many splats are visible. */
  readonly visibleCount: GPUBuffer;
  readonly keys: GPUBuffer;
  /** After the sort: the visible splats back to front. */
  readonly order: GPUBuffer;
  readonly drawArguments: GPUBuffer;
}

/** Textures that splats are blended in, or that take them from there. */
export interface LayerTextures {
  /** Premultiplied RGBA in the space that splats are blended in. */
  readonly color: GPUTexture;
  /** View depth weighted like the colours, where the shape asks for it. */
  readonly depthLayer: GPUTexture | null;
}

/** What parts hold for one another. Each part puts its own in, in `commit`, and reads that of others in `bind` and `record`. */
export class SharedMemory {
  readonly buffers = {} as { -readonly [Name in keyof SharedBuffers]: SharedBuffers[Name] };
  /** One `HostDepth`, for shapes with depth. */
  hostDepth: GPUBuffer | null = null;
  /** One `HostViewport`, for frames inside another renderer's. */
  viewport: GPUBuffer | null = null;
  /** Buffers of kept colours, by page of the frame; null where none are kept. */
  keptColors: readonly (GPUBuffer | null)[] = [];
  /** What splats are blended in: of the image's size, or smaller. */
  blended: LayerTextures | null = null;
  /** The blended splats at the image's size. */
  image: LayerTextures | null = null;
  /** The host's depth at the size of `blended`. */
  testedDepth: GPUTexture | null = null;
}

export interface PartContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
  readonly shared: SharedMemory;
}

/** A change of what a part holds, ready to be made: `free` and `commit` are called, or `discard`. */
export interface PartChange {
  /**
   * Frees memory before any part commits: textures of the image's size that `commit` replaces, so that old and new are never
   * held together.
   */
  free?(): void;
  /** Takes over and frees what it replaces; cannot fail. */
  commit(): void;
  /** Frees what was made for it. */
  discard(): void;
}

/** What lies behind the splats, between two passes of the host. */
export interface HostPass {
  /** Linear light, premultiplied, one sample; with TEXTURE_BINDING or else COPY_SRC. */
  readonly color: GPUTexture;
  /** Of one or several samples, with TEXTURE_BINDING; null where the host has none. */
  readonly depth: GPUTexture | null;
  /** Top left of the viewport within both, in pixels. */
  readonly xPx: number;
  readonly yPx: number;
  /** Layer of textures that have several, e.g. a cube's face; default 0. */
  readonly layer?: number;
}

/** Where one frame is drawn; of the kind that its shape's `output` names. */
export type Destination =
  | { readonly kind: 'image' }
  | { readonly kind: 'canvas'; readonly canvas: GPUCanvasContext; readonly background: Vec3 }
  | { readonly kind: 'host'; readonly pass: HostPass };

export interface Recording {
  readonly encoder: GPUCommandEncoder;
  readonly timer: GpuTimer;
  readonly shape: FrameShape;
}

export interface OrderRecording extends Recording {
  /** Only colours have changed since the last frame: the visible splats and their order stay. */
  readonly isColorsOnly: boolean;
}

export interface DrawRecording extends Recording {
  readonly destination: Destination;
}

/**
 * A group of a frame's stages with the GPU memory that they need. A part that a shape does not use runs no stages and holds
 * nothing. Only frame.ts puts parts in order.
 */
export interface FramePart<R extends Recording = Recording> {
  /**
   * What the part has to change to hold what `plan` needs; null where it holds that already.
   *
   * @throws GpuLimitError where a buffer would pass the device's limits; nothing stays allocated then.
   */
  fit(plan: FramePlan): PartChange | null;
  /** Binds the stages of `shape` to buffers, once all parts have what they need. */
  bind(shape: FrameShape): void;
  /** Writes everything that changes from frame to frame. */
  write(plan: FramePlan): void;
  record(recording: R): void;
  destroy(): void;
}

/** A part before it is made: the stages that it runs are known without it. */
export interface PartClass<R extends Recording = Recording> {
  new (context: PartContext): FramePart<R>;
  /** Stages that frames of this shape run in this part; none where they do not use it. */
  stages(shape: FrameShape): readonly CompiledStage[];
}

/** Sets pipeline and bind group of a compute stage that has been compiled. */
export function useCompute(
  pass: GPUComputePassEncoder,
  pipelines: Pipelines,
  stage: StageDefinition,
  group: GPUBindGroup,
): void {
  pass.setPipeline(pipelines.compute(stage)!);
  pass.setBindGroup(0, group);
}

/** Draws one triangle over all of the target by a render stage that has been compiled. */
export function drawOverAll(
  pass: GPURenderPassEncoder,
  pipelines: Pipelines,
  [stage, state]: readonly [StageDefinition, RenderState],
  group: GPUBindGroup,
): void {
  pass.setPipeline(pipelines.render(stage, state)!);
  pass.setBindGroup(0, group);
  pass.draw(3);
}
