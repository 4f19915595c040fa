import type { Bindings, Pipelines, StageDefinition } from './pipelines.ts';
import type { TimedPass } from './timing/frame-statistics.ts';

// A frame as data: a list of passes, each with the dispatches or draws of its stages. `FrameParts`
// records the list, `FrameProfile` times each stage of it, and `FrameDivider` submits it in parts.

/** Where the GPU has written the size of a dispatch or draw. */
export interface IndirectArguments {
  readonly buffer: GPUBuffer;
  readonly offset: number;
}

/** Workgroups of a dispatch: x, y and z, or where the GPU has written them. */
export type DispatchSize = readonly [x: number, y: number, z: number] | IndirectArguments;

/** A compute stage with its bindings and size. Made once for all frames that use the same buffers. */
export interface Dispatch {
  /** Its label names the stage: see `stageNameOf`. */
  readonly pipeline: GPUComputePipeline;
  readonly group: GPUBindGroup;
  readonly size: DispatchSize;
}

/** The size of a dispatch of one workgroup. */
export const ONE_WORKGROUP: DispatchSize = [1, 1, 1];

/** Binds a compiled compute stage; ignores `resources` that it does not declare. */
export function dispatchOf(
  pipelines: Pipelines,
  stage: StageDefinition,
  resources: Bindings,
  size: DispatchSize,
): Dispatch {
  return { pipeline: pipelines.compute(stage)!, group: pipelines.bindGroup(stage, resources), size };
}

type TextureCopy = Parameters<GPUCommandEncoder['copyTextureToTexture']>;

/** A pass that runs compute stages. */
export interface ComputePass {
  readonly label: string;
  /** Name of its times in the statistics. */
  readonly timed: TimedPass;
  /** Textures that are copied before the pass and after it. */
  readonly copyBefore?: TextureCopy;
  readonly copyAfter?: TextureCopy;
  readonly dispatches: readonly Dispatch[];
}

/** Arguments of a draw, or where the GPU has written them. */
export type DrawSize =
  | readonly [vertices: number, instances?: number, firstVertex?: number, firstInstance?: number]
  | IndirectArguments;

/** A pass that draws with one render stage. */
export interface RenderPass {
  readonly label: string;
  /** Name of its times in the statistics. */
  readonly timed: TimedPass;
  readonly targets: Pick<GPURenderPassDescriptor, 'colorAttachments' | 'depthStencilAttachment'>;
  readonly pipeline: GPURenderPipeline;
  readonly group: GPUBindGroup;
  readonly draws: readonly DrawSize[];
}

export type FramePass = ComputePass | RenderPass;

/** @param timestampWrites undefined for a pass that is not timed. */
export function recordPass(
  encoder: GPUCommandEncoder,
  pass: FramePass,
  timestampWrites: (GPUComputePassTimestampWrites & GPURenderPassTimestampWrites) | undefined,
): void {
  const { label } = pass;
  if ('dispatches' in pass) {
    if (pass.copyBefore) encoder.copyTextureToTexture(...pass.copyBefore);
    const recorded = encoder.beginComputePass({ label, timestampWrites });
    recordDispatches(recorded, pass.dispatches);
    recorded.end();
    if (pass.copyAfter) encoder.copyTextureToTexture(...pass.copyAfter);
    return;
  }
  const recorded = encoder.beginRenderPass({ label, ...pass.targets, timestampWrites });
  recorded.setPipeline(pass.pipeline);
  recorded.setBindGroup(0, pass.group);
  for (const draw of pass.draws) {
    if ('buffer' in draw) recorded.drawIndirect(draw.buffer, draw.offset);
    else recorded.draw(...draw);
  }
  recorded.end();
}

/** Records dispatches in order. A pipeline is set only where it changes: pages share most of them. */
export function recordDispatches(pass: GPUComputePassEncoder, dispatches: readonly Dispatch[]): void {
  let current: GPUComputePipeline | null = null;
  for (const { pipeline, group, size } of dispatches) {
    if (pipeline !== current) pass.setPipeline(pipeline);
    current = pipeline;
    pass.setBindGroup(0, group);
    if ('buffer' in size) pass.dispatchWorkgroupsIndirect(size.buffer, size.offset);
    else pass.dispatchWorkgroups(...size);
  }
}
