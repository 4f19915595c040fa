import type { FrameResources, FrameShape } from './frame-resources.ts';
import { cullSplatsStage, projectStage } from './frame-resources.ts';
import type { Pipelines, RenderState, StageDefinition } from './gpu/pipelines.ts';
import { SHADER_CONSTANTS } from './layout/constants.ts';
import { compactChunks } from './stages/compact-chunks.ts';
import { compactSplats } from './stages/compact-splats.ts';
import { cullChunks } from './stages/cull-chunks.ts';
import { dispatchSize } from './stages/dispatch.ts';
import { planCull } from './stages/plan-cull.ts';
import { planProject } from './stages/plan-project.ts';
import { prefixScanStages } from './stages/prefix-scan.ts';
import { radixSortStages } from './stages/radix-sort.ts';
import { rasterize, rasterizeState } from './stages/rasterize.ts';
import { sortShapeFor } from './stages/sort-shape.ts';
import type { GpuTimer } from './timing/gpu-timer.ts';

/** All that `recordFrame` runs for a frame of this shape: to be compiled before. */
export function frameStages(
  shape: FrameShape,
): (StageDefinition | readonly [StageDefinition, RenderState])[] {
  const { recordPrecision, colorTarget } = shape.accuracy;
  return [
    cullChunks,
    ...prefixScanStages,
    compactChunks,
    planCull,
    cullSplatsStage(shape),
    planProject,
    compactSplats,
    ...shape.clouds.map((cloud) => projectStage(shape, cloud)),
    ...radixSortStages(sortShapeFor(shape.keyBits)),
    [rasterize(recordPrecision), rasterizeState(colorTarget)],
  ];
}

/** The stages in their order. Blends the clouds into `target`, which is cleared to nothing first. */
export function recordFrame(
  encoder: GPUCommandEncoder,
  pipelines: Pipelines,
  frame: FrameResources,
  target: GPUTextureView,
  timer: GpuTimer,
): void {
  const { shape, groups, pages } = frame;
  const { dispatchRow } = shape;
  // Of no chunks too: Dawn warns of dispatches of nothing.
  const chunkWorkgroups = (chunks: number) =>
    dispatchSize(Math.max(1, Math.ceil(chunks / SHADER_CONSTANTS.CHUNK_WORKGROUP)), dispatchRow);
  const use = (pass: GPUComputePassEncoder, stage: StageDefinition, group: GPUBindGroup) => {
    pass.setPipeline(pipelines.compute(stage)!);
    pass.setBindGroup(0, group);
  };

  const preprocess = encoder.beginComputePass({
    label: 'pre-process',
    timestampWrites: timer.writes('preprocess'),
  });
  for (const [index, { chunkCount }] of pages.entries()) {
    use(preprocess, cullChunks, groups.pages[index].cullChunks);
    preprocess.dispatchWorkgroups(...chunkWorkgroups(chunkCount));
  }
  frame.chunkScan.record(preprocess);
  use(preprocess, compactChunks, groups.compactChunks);
  preprocess.dispatchWorkgroups(...chunkWorkgroups(frame.chunkCount));
  use(preprocess, planCull, groups.planCull);
  preprocess.dispatchWorkgroups(1);
  for (const index of pages.keys()) {
    use(preprocess, cullSplatsStage(shape), groups.pages[index].cullSplats);
    preprocess.dispatchWorkgroupsIndirect(frame.buffers.cullDispatches, 12 * index);
  }
  frame.splatScan.record(preprocess);
  use(preprocess, planProject, groups.planProject);
  preprocess.dispatchWorkgroups(1);
  use(preprocess, compactSplats, groups.compactSplats);
  preprocess.dispatchWorkgroupsIndirect(frame.buffers.cullDispatches, 12 * pages.length);
  for (const [index, { cloudIndex }] of pages.entries()) {
    use(preprocess, projectStage(shape, shape.clouds[cloudIndex]), groups.pages[index].project);
    preprocess.dispatchWorkgroupsIndirect(frame.buffers.projectDispatches, 12 * index);
  }
  preprocess.end();

  const sort = encoder.beginComputePass({ label: 'sort', timestampWrites: timer.writes('sort') });
  frame.sort.record(sort);
  sort.end();

  const raster = encoder.beginRenderPass({
    label: 'rasterize',
    colorAttachments: [{ view: target, loadOp: 'clear', storeOp: 'store', clearValue: [0, 0, 0, 0] }],
    timestampWrites: timer.writes('rasterize'),
  });
  raster.setPipeline(
    pipelines.render(rasterize(shape.accuracy.recordPrecision), rasterizeState(shape.accuracy.colorTarget))!,
  );
  raster.setBindGroup(0, groups.rasterize);
  raster.drawIndirect(frame.buffers.drawArguments, 0);
  raster.end();
}
