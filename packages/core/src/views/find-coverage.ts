import type { Camera, Projection } from '../data/camera/camera.ts';
import { storedDepth } from '../data/camera/depth-convention.ts';
import { DestroyedError, GpuLimitError, InvalidArgumentError } from '../data/errors.ts';
import { checkKind, given } from '../data/given.ts';
import { COVER_CONSTANTS, CoverParameters, CoverPoint } from '../data/layout/cover-structs.ts';
import { isFiniteF32 } from '../data/math/float-step.ts';
import { linearPart, transform3, type Vec3 } from '../data/math/mat4.ts';
import { shown } from '../data/printable.ts';
import type { FrameParts } from '../frame/frame.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../gpu/pipelines.ts';
import { readBack } from '../gpu/read-back.ts';
import { readFromScratch } from '../gpu/read-from-scratch.ts';
import { COVER_WORKGROUP, coverPoints } from '../stages/cover/cover.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { searchFrame } from './search-frame.ts';
import type { ViewFrames } from './view-frames.ts';

/** Most points per call, because every visible splat is compared with all of them. */
export const MAX_COVER_POINTS = 1024;

/** A point of the world, and its tolerance. */
export interface PointToCover {
  readonly point: Vec3;
  /**
   * Splats and host objects less than this in front of the point do not cover it, in world units
   * along the line of sight. A point on a surface needs some tolerance, because the surface's
   * splats lie on both sides of it. Default: 0.
   */
  readonly tolerance?: number;
}

/** How far a point was covered in the last frame. */
export interface PointCoverage {
  /** Whether the point is within the image and the near and far planes. If not, nothing covers it. */
  readonly isInImage: boolean;
  /** Combined opacity of all splats in front of the point at its pixel, 0…1. */
  readonly opacity: number;
  /** Whether an opaque object of the host, in the tested depth buffer, is in front of the point. */
  readonly isBehindHost: boolean;
}

interface CoverContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
  readonly counting: Pick<Counting, 'readbacks'>;
}

/** Position of a point in a frame. */
interface PlacedPoint {
  /** Centre of its pixel in the layer. */
  readonly pixelPx: readonly [number, number];
  /** View depth, minus the tolerance. */
  readonly depthView: number;
  readonly storedDepth: number;
}

const UNCOVERED = { opacity: 0, isBehindHost: false } as const;

/** @throws InvalidArgumentError for too many points, and for numbers that are not finite. */
function checkPoints(points: readonly PointToCover[]): void {
  checkKind('points', points, 'a list');
  if (points.length > MAX_COVER_POINTS) {
    const message = `${points.length} points are more than ${MAX_COVER_POINTS}: ask for them in several calls.`;
    throw new InvalidArgumentError('points', message);
  }
  for (const [i, each] of points.entries()) {
    const { point, tolerance = 0 } = given(each, { tolerance: 'a number?' }, `points[${i}]`);
    if (point?.length !== 3 || !Array.prototype.every.call(point, isFiniteF32)) {
      throw new InvalidArgumentError('points', `Point ${i} is ${shown(point)}; it must be 3 finite numbers.`);
    }
    if (!(isFiniteF32(tolerance) && tolerance >= 0)) {
      const message = `The tolerance of point ${i} is ${shown(tolerance)}; it must be a length of 0 or more.`;
      throw new InvalidArgumentError('tolerance', message);
    }
  }
}

/** The stage that computes coverage in frames like the last one of `frame`. */
export function coverStage({ shared }: FrameParts, { shape }: FramePlan): StageDefinition {
  const compare = shared.resources.testedDepth && shape.depth?.isTested ? shape.depth.compare : null;
  return coverPoints(shape.accuracy.recordPrecision, compare, shape.isStacked);
}

/**
 * Computes the coverage of `points` in the frame of `plan`, the last one of `frame`. Submits before
 * it returns, so later frames do not matter. `stage`, from `coverStage`, must be compiled.
 *
 * @throws GpuLimitError if the device lacks memory; DestroyedError if engine or device end before
 *   the result is read.
 */
export async function findCoverage(
  context: CoverContext,
  { shared }: FrameParts,
  plan: FramePlan,
  stage: StageDefinition,
  points: readonly PointToCover[],
): Promise<PointCoverage[]> {
  const placed = points.map((point) => placedIn(plan, point));
  const inImage = placed.filter((point) => point !== null);
  if (inImage.length === 0) return placed.map(() => ({ isInImage: false, ...UNCOVERED }));
  const { device, pipelines, memory } = context;
  const { visibleCapacity, dispatchRow } = plan.shape;
  const { UNIFORM, STORAGE, COPY_SRC, COPY_DST } = GPUBufferUsage;
  const bytes = 8 * inImage.length;
  const threads = Math.max(visibleCapacity, inImage.length);
  const find = (scratch: GpuMemory) => {
    const create = (label: string, contents: ArrayBuffer, usage: GPUBufferUsageFlags) => {
      const buffer = scratch.createBuffer(label, contents.byteLength, usage | COPY_DST);
      device.queue.writeBuffer(buffer, 0, contents);
      return buffer;
    };
    const parameters = CoverParameters.pack({ pointCount: inImage.length });
    const packed = new ArrayBuffer(CoverPoint.bytes * inImage.length);
    for (const [i, point] of inImage.entries()) CoverPoint.write(packed, point, CoverPoint.bytes * i);
    const covers = create('covers', new ArrayBuffer(bytes), STORAGE | COPY_SRC);
    const group = pipelines.bindGroup(stage, {
      ...shared.resources,
      parameters: create('cover parameters', parameters, UNIFORM),
      points: create('points to cover', packed, STORAGE),
      covers,
    });
    return readBack(device, bytes, (encoder, target) => {
      const pass = encoder.beginComputePass({ label: 'cover points' });
      pass.setPipeline(pipelines.compute(stage)!);
      pass.setBindGroup(0, group);
      pass.dispatchWorkgroups(...dispatchSize(Math.ceil(threads / COVER_WORKGROUP), dispatchRow));
      pass.end();
      encoder.copyBufferToBuffer(covers, 0, target, 0, bytes);
    });
  };
  context.counting.readbacks++;
  try {
    const found = await readFromScratch(
      memory,
      'Finding what covers points',
      'Ask when less is shown.',
      find,
    );
    return coveragesOf(placed, new Uint32Array(found), plan.request.fade);
  } catch (error) {
    if (error instanceof GpuLimitError) throw error;
    throw new DestroyedError('What covers points', (error as Error).message);
  }
}

/** Computes the coverage of `points` in a view's last frame; null before the first. */
export async function coverageInView(
  frames: ViewFrames,
  points: readonly PointToCover[],
): Promise<PointCoverage[] | null> {
  checkPoints(points);
  return searchFrame(
    frames,
    (plan) => coverStage(frames.parts, plan),
    (plan, stage) => findCoverage(frames.context, frames.parts, plan, stage, points),
  );
}

/** @param covers two words per point in the image. */
function coveragesOf(
  placed: readonly (PlacedPoint | null)[],
  covers: Uint32Array,
  fade = 1,
): PointCoverage[] {
  let at = 0;
  return placed.map((point) => {
    if (!point) return { isInImage: false, ...UNCOVERED };
    const [absorbed, isBehindHost] = covers.subarray(at, at + 2);
    at += 2;
    return {
      isInImage: true,
      opacity: fade * (1 - Math.exp(-absorbed / COVER_CONSTANTS.COVER_UNITS)),
      isBehindHost: isBehindHost > 0,
    };
  });
}

/** Returns the position of a point in the layer of a frame; null outside. */
function placedIn(
  { camera, projection, shape }: FramePlan,
  { point, tolerance = 0 }: PointToCover,
): PlacedPoint | null {
  const { viewMatrix } = camera;
  const turned = transform3(linearPart(viewMatrix), point);
  const depthView = -(turned[2] + viewMatrix[14]);
  const pixel = pixelOf(projection, [turned[0] + viewMatrix[12], turned[1] + viewMatrix[13]], depthView);
  if (!pixel || !(depthView > camera.near && depthView <= camera.far)) return null;
  const pixelPx = [Math.floor(pixel[0]) + 0.5, Math.floor(pixel[1]) + 0.5] as const;
  const front = Math.max(camera.near, depthView - tolerance);
  return { pixelPx, depthView: front, storedDepth: stored(camera, projection, shape.depth, pixelPx, front) };
}

function pixelOf(
  { isOrthographic, focalPx, centerPx, widthPx, heightPx }: Projection,
  [x, y]: readonly [number, number],
  depthView: number,
): readonly [number, number] | null {
  const divisor = isOrthographic ? 1 : depthView;
  const xPx = centerPx[0] + (focalPx[0] * x) / divisor;
  const yPx = centerPx[1] - (focalPx[1] * y) / divisor;
  return xPx >= 0 && xPx < widthPx && yPx >= 0 && yPx < heightPx ? [xPx, yPx] : null;
}

function stored(
  camera: Camera,
  { widthPx, heightPx }: Projection,
  depth: FramePlan['shape']['depth'],
  [xPx, yPx]: readonly [number, number],
  depthView: number,
): number {
  if (!depth) return 0;
  const ndc = [(2 * xPx) / widthPx - 1, 1 - (2 * yPx) / heightPx] as const;
  return storedDepth(depthView, camera, depth.mapping, ndc);
}
