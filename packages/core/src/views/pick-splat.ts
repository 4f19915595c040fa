import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { NO_ROW } from '../data/bricks/leaf-scene.ts';
import { pixelRay } from '../data/camera/camera.ts';
import { DestroyedError, GpuLimitError, InvalidArgumentError } from '../data/errors.ts';
import { PICK_CONSTANTS, PickBlock, PickParameters } from '../data/layout/pick-structs.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import type { FrameParts } from '../frame/frame.ts';
import { locateSplat } from '../frame/frame-pages.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../gpu/pipelines.ts';
import { readBack } from '../gpu/read-back.ts';
import { readFromScratch } from '../gpu/read-from-scratch.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { pick } from '../stages/pick/pick.ts';
import { firstSplatOf } from './first-splat-of.ts';
import { searchFrame } from './search-frame.ts';
import type { ViewFrames } from './view-frames.ts';

/** The stage that picks splats in frames of this plan. */
function pickStage({ shape }: Pick<FramePlan, 'shape'>): StageDefinition {
  return pick(shape.accuracy.recordPrecision, shape.isStacked);
}

/** The splat that contributes most to a pixel. */
export interface SplatPick {
  /** Index in the frame's list of clouds. */
  readonly cloudIndex: number;
  /** Index in the list of the cloud's instances; null if the cloud has none. */
  readonly instanceIndex: number | null;
  readonly cloud: SplatCloud;
  /**
   * Row of the splat in its cloud's file; for a blob, the row of the first splat merged into it.
   */
  readonly row: number;
  /** Index of the splat in storage order. */
  readonly storedIndex: number;
  /** View depth of the splat's centre, world units. */
  readonly depthView: number;
  /** World point at that depth on the ray through the pixel's centre. */
  readonly point: Vec3;
  /** The splat's opacity at the pixel, cutoff…0.99. */
  readonly alpha: number;
  /** The splat's contribution to the pixel: `alpha` times the transmittance in front of it. */
  readonly weight: number;
  /** Combined opacity of all splats at the pixel. */
  readonly totalOpacity: number;
  /** Index of the splat among all visible ones by depth; 0 is the nearest. */
  readonly rank: number;
}

interface PickContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
  readonly counting: Pick<Counting, 'readbacks'>;
  /** Reason why the engine has ended; null if it has not. */
  readonly destroyedBecause: () => string | null;
}

/**
 * Picks the splat that contributes most to one pixel of the layer that `frame` was last sorted for;
 * the foremost of equal contributions. Submits before it returns, so later frames and the
 * destruction of `frame` do not matter. Repeated picks in the same frame return the same splat.
 * Objects of other renderers in front of the splats are ignored.
 *
 * `pickStage` must be compiled.
 *
 * @param plan the plan of that frame.
 * @param xPx column in the layer, from the left; the pixel that contains the point is picked.
 * @param yPx row, from the top.
 * @returns null if no splat reaches the cutoff at the pixel; for splats of previews and of coarser
 *   levels of a streamed scene; for blobs if the cloud is destroyed, or its levels are rebuilt,
 *   before the result.
 * @throws InvalidArgumentError outside the layer; GpuLimitError if the device lacks memory;
 *   DestroyedError if engine or device end before the result is read.
 */
export async function pickSplat(
  context: PickContext,
  frame: FrameParts,
  { camera, projection, shape }: FramePlan,
  xPx: number,
  yPx: number,
): Promise<SplatPick | null> {
  const { widthPx, heightPx } = projection;
  if (!(xPx >= 0 && xPx < widthPx && yPx >= 0 && yPx < heightPx)) {
    const message = `Pixel ${xPx}, ${yPx} is outside the layer of ${widthPx}×${heightPx} px.`;
    throw new InvalidArgumentError('xPx', message);
  }
  const pixelPx = [Math.floor(xPx) + 0.5, Math.floor(yPx) + 0.5] as const;
  const { origin, direction } = pixelRay(camera, projection, pixelPx);
  const { pages } = frame;

  context.counting.readbacks++;
  const blocks = await readBlocks(context, frame, pixelPx);
  const found = heaviestOf(blocks);
  if (!found) return null;
  const { splat, ...shares } = found;
  const located = locateSplat(pages, splat);
  const { cloudIndex, instanceIndex, blob } = located;
  const { cloud, levels } = shape.clouds[cloudIndex];
  // A preview's rows are unknown until it has loaded.
  if (cloud.isPreview) return null;
  const storedIndex = blob ? await firstSplatOf(context.device, cloud, levels!, blob) : located.storedIndex;
  if (storedIndex === null) {
    const reason = context.destroyedBecause();
    if (reason !== null) throw new DestroyedError('This pick', reason);
    return null;
  }
  const row = cloud.fileIndices[storedIndex];
  if (row === NO_ROW) return null;
  const along = (axis: number) => origin[axis] + found.depthView * direction[axis];
  return {
    ...shares,
    cloudIndex,
    instanceIndex,
    cloud,
    storedIndex,
    row,
    point: [along(0), along(1), along(2)],
  };
}

/**
 * Picks like `pickSplat`, at a pixel of a view's last image. If the layer is smaller, the layer's
 * pixel at its centre is used. Null outside the image, and before the first frame.
 */
export function pickInView(frames: ViewFrames, xPx: number, yPx: number): Promise<SplatPick | null> {
  return searchFrame(frames, pickStage, async (plan) => {
    const { widthPx, heightPx } = plan.request;
    if (!(xPx >= 0 && xPx < widthPx && yPx >= 0 && yPx < heightPx)) return null;
    const layerX = ((Math.floor(xPx) + 0.5) * plan.layer.widthPx) / widthPx;
    const layerY = ((Math.floor(yPx) + 0.5) * plan.layer.heightPx) / heightPx;
    return pickSplat(frames.context, frames.parts, plan, layerX, layerY);
  });
}

/** Runs the stage and reads its blocks back, as many as the visible capacity needs. */
async function readBlocks(
  { device, pipelines, memory }: PickContext,
  { shared, shape }: FrameParts,
  pixelPx: readonly [number, number],
): Promise<ArrayBuffer> {
  const { visibleCapacity, dispatchRow } = shape!;
  const blockCount = Math.ceil(visibleCapacity / PICK_CONSTANTS.PICK_WORKGROUP);
  if (blockCount === 0) return new ArrayBuffer(0);
  const bytes = blockCount * PickBlock.bytes;
  const { UNIFORM, STORAGE, COPY_SRC, COPY_DST } = GPUBufferUsage;
  const find = (scratch: GpuMemory) => {
    const parameters = scratch.createBuffer('pick parameters', PickParameters.bytes, UNIFORM | COPY_DST);
    const blocks = scratch.createBuffer('pick blocks', bytes, STORAGE | COPY_SRC);
    const contents = PickParameters.pack({ pixelPx, blockCount });
    device.queue.writeBuffer(parameters, 0, contents);
    const stage = pickStage({ shape: shape! });
    const group = pipelines.bindGroup(stage, { ...shared.resources, parameters, blocks });
    return readBack(device, bytes, (encoder, target) => {
      const pass = encoder.beginComputePass({ label: 'pick' });
      pass.setPipeline(pipelines.compute(stage)!);
      pass.setBindGroup(0, group);
      pass.dispatchWorkgroups(...dispatchSize(blockCount, dispatchRow));
      pass.end();
      encoder.copyBufferToBuffer(blocks, 0, target, 0, bytes);
    });
  };
  try {
    return await readFromScratch(memory, 'Picking', 'Pick when less is shown.', find);
  } catch (error) {
    if (error instanceof GpuLimitError) throw error;
    throw new DestroyedError('This pick', (error as Error).message);
  }
}

/**
 * Combines blocks front to back, in float64. Returns the splat of the largest weight; null if none.
 */
function heaviestOf(blocks: ArrayBuffer) {
  const floats = new Float32Array(blocks);
  const words = new Uint32Array(blocks);
  const stride = PickBlock.bytes / 4;
  const { transmittance, weight, splat, alpha, depthView, rank } = PickBlock.offsets;
  let through = 1;
  let heaviest = { splat: 0, alpha: 0, depthView: 0, rank: 0, weight: 0 };
  for (let at = floats.length - stride; at >= 0; at -= stride) {
    const share = through * floats[at + weight / 4];
    if (share > heaviest.weight) {
      heaviest = {
        splat: words[at + splat / 4],
        alpha: floats[at + alpha / 4],
        depthView: floats[at + depthView / 4],
        rank: words[at + rank / 4],
        weight: share,
      };
    }
    through *= floats[at + transmittance / 4];
  }
  return heaviest.weight > 0 ? { ...heaviest, totalOpacity: 1 - through } : null;
}
