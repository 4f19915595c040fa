import type { Bindings, Pipelines, StageDefinition } from './pipelines.ts';

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
