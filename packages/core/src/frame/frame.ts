import type { CompiledStage, Pipelines, StageDefinition } from '../gpu/pipelines.ts';
import { SHADER_CONSTANTS } from '../layout/constants.ts';
import { compactChunks } from '../stages/compact-chunks.ts';
import { compactSplats } from '../stages/compact-splats.ts';
import { cullChunks } from '../stages/cull-chunks.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { planCull } from '../stages/plan-cull.ts';
import { planProject } from '../stages/plan-project.ts';
import { prefixScanStages } from '../stages/prefix-scan.ts';
import { radixSortStages } from '../stages/radix-sort.ts';
import { sortShapeFor } from '../stages/sort-shape.ts';
import type { GpuTimer } from '../timing/gpu-timer.ts';
import {
  cullSplatsStage,
  type FrameResources,
  keepColorsStage,
  projectStage,
  rasterizeStage,
  upscaleStage,
} from './frame-resources.ts';
import { type FrameShape, isScaled } from './frame-shape.ts';

/** All that `recordCompute` and `recordRasterize` run for a frame of this shape: to be compiled before. */
export function frameStages(shape: FrameShape): CompiledStage[] {
  return [
    cullChunks,
    ...prefixScanStages,
    compactChunks,
    planCull,
    ...shape.clouds.map((_, cloudIndex) => cullSplatsStage(shape, cloudIndex)),
    planProject,
    compactSplats,
    ...shape.clouds.map((_, cloudIndex) => projectStage(shape, cloudIndex)),
    ...(shape.keepsColors.includes(true) ? [keepColorsStage(shape)] : []),
    ...radixSortStages(sortShapeFor(shape.keyBits)),
    rasterizeStage(shape),
    ...(isScaled(shape) ? [upscaleStage(shape)] : []),
  ];
}

/** Those of them that keep the colours of clouds: none where none are kept. */
export function keepingStages(shape: FrameShape): CompiledStage[] {
  const projecting = shape.clouds.flatMap((_, cloudIndex) =>
    shape.keepsColors[cloudIndex] ? [projectStage(shape, cloudIndex)] : [],
  );
  return projecting.length > 0 ? [...projecting, keepColorsStage(shape)] : [];
}

/**
 * Pre-process and sort: afterwards the visible splats are known, and their order.
 *
 * @param isColorsOnly only colours have changed since the last frame: what is visible, and its order, stay.
 */
export function recordCompute(
  encoder: GPUCommandEncoder,
  pipelines: Pipelines,
  frame: FrameResources,
  timer: GpuTimer,
  isColorsOnly = false,
): void {
  const { shape, groups, pages, buffers } = frame;
  const preprocess = encoder.beginComputePass({
    label: 'pre-process',
    timestampWrites: timer.writes('preprocess'),
  });
  if (!isColorsOnly) recordCulling(preprocess, pipelines, frame);
  for (const [index, { cloudIndex }] of pages.entries()) {
    use(preprocess, pipelines, projectStage(shape, cloudIndex), groups.pages[index].project);
    preprocess.dispatchWorkgroupsIndirect(buffers.projectDispatches, 12 * index);
  }
  preprocess.end();
  if (isColorsOnly) return;

  const sort = encoder.beginComputePass({ label: 'sort', timestampWrites: timer.writes('sort') });
  frame.sort.record(sort);
  sort.end();
}

/** Keeps the colours with which `frame` was drawn, of these pages: before it is prepared anew, or freed. */
export function recordKeepColors(
  encoder: GPUCommandEncoder,
  pipelines: Pipelines,
  frame: FrameResources,
  pageIndices: readonly number[],
): void {
  const pass = encoder.beginComputePass({ label: 'keep colors' });
  for (const index of pageIndices) {
    use(pass, pipelines, keepColorsStage(frame.shape), frame.keepColorsGroup(index));
    pass.dispatchWorkgroupsIndirect(frame.buffers.projectDispatches, 12 * index);
  }
  pass.end();
}

/** Lists the visible splats in storage order. */
function recordCulling(pass: GPUComputePassEncoder, pipelines: Pipelines, frame: FrameResources): void {
  const { shape, groups, pages, buffers } = frame;
  const { dispatchRow } = shape;
  // Of no chunks too: Dawn warns of dispatches of nothing.
  const chunkWorkgroups = (chunks: number) =>
    dispatchSize(Math.max(1, Math.ceil(chunks / SHADER_CONSTANTS.CHUNK_WORKGROUP)), dispatchRow);
  for (const [index, { chunkCount }] of pages.entries()) {
    use(pass, pipelines, cullChunks, groups.pages[index].cullChunks);
    pass.dispatchWorkgroups(...chunkWorkgroups(chunkCount));
  }
  frame.chunkScan.record(pass);
  use(pass, pipelines, compactChunks, groups.compactChunks);
  pass.dispatchWorkgroups(...chunkWorkgroups(frame.chunkCount));
  use(pass, pipelines, planCull, groups.planCull);
  pass.dispatchWorkgroups(1);
  for (const [index, { cloudIndex }] of pages.entries()) {
    use(pass, pipelines, cullSplatsStage(shape, cloudIndex), groups.pages[index].cullSplats);
    pass.dispatchWorkgroupsIndirect(buffers.cullDispatches, 12 * index);
  }
  frame.splatScan.record(pass);
  use(pass, pipelines, planProject, groups.planProject);
  pass.dispatchWorkgroups(1);
  use(pass, pipelines, compactSplats, groups.compactSplats);
  pass.dispatchWorkgroupsIndirect(buffers.cullDispatches, 12 * pages.length);
}

function use(
  pass: GPUComputePassEncoder,
  pipelines: Pipelines,
  stage: StageDefinition,
  group: GPUBindGroup,
): void {
  pass.setPipeline(pipelines.compute(stage)!);
  pass.setBindGroup(0, group);
}

/** Where splats are blended; all of one size. */
export interface RasterizeTargets {
  readonly color: GPUTexture;
  /** Their depth, where the frame's shape asks for it. */
  readonly depthLayer: GPUTexture | null;
  /** What the host has drawn, where the frame's shape has depth. */
  readonly testedDepth: GPUTexture | null;
}

/** Blends the visible splats in their order into `targets`, which are cleared to nothing first. */
export function recordRasterize(
  encoder: GPUCommandEncoder,
  pipelines: Pipelines,
  frame: FrameResources,
  { color, depthLayer, testedDepth }: RasterizeTargets,
  timer: GpuTimer,
): void {
  const pass = encoder.beginRenderPass({
    label: 'rasterize',
    colorAttachments: [color, depthLayer]
      .filter((texture) => texture !== null)
      .map((texture) => ({
        view: texture.createView(),
        loadOp: 'clear',
        storeOp: 'store',
        clearValue: [0, 0, 0, 0],
      })),
    ...(testedDepth && {
      depthStencilAttachment: { view: testedDepth.createView(), depthReadOnly: true },
    }),
    timestampWrites: timer.writes('rasterize'),
  });
  pass.setPipeline(pipelines.render(...rasterizeStage(frame.shape))!);
  pass.setBindGroup(0, frame.groups.rasterize);
  pass.drawIndirect(frame.buffers.drawArguments, 0);
  pass.end();
}

/** What splats were blended into, and what takes them at the picture's size. */
export interface UpscaleTargets {
  readonly from: Pick<RasterizeTargets, 'color' | 'depthLayer'>;
  readonly to: Pick<RasterizeTargets, 'color' | 'depthLayer'>;
  /** One `UpscaleParameters`. */
  readonly parameters: GPUBuffer;
}

/** Brings the blended splats to the picture's size, where the frame's shape scales them. */
export function recordUpscale(
  encoder: GPUCommandEncoder,
  pipelines: Pipelines,
  { shape }: FrameResources,
  { from, to, parameters }: UpscaleTargets,
  timer: GpuTimer,
): void {
  const [stage, state] = upscaleStage(shape);
  const pass = encoder.beginRenderPass({
    label: 'upscale',
    colorAttachments: [to.color, to.depthLayer]
      .filter((texture) => texture !== null)
      .map((texture) => ({ view: texture.createView(), loadOp: 'clear', storeOp: 'store' })),
    timestampWrites: timer.writes('upscale'),
  });
  pass.setPipeline(pipelines.render(stage, state)!);
  const bindings = {
    parameters,
    layer: from.color.createView(),
    ...(from.depthLayer && { depthLayer: from.depthLayer.createView() }),
  };
  pass.setBindGroup(0, pipelines.bindGroup(stage, bindings));
  pass.draw(3);
  pass.end();
}
