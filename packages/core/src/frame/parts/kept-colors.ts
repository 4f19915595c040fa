import { type AccuracySettings, maxColor } from '../../accuracy/accuracy.ts';
import { hasHook } from '../../effects/effect-set.ts';
import { CLOUD_EFFECTS } from '../../effects/effects.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { Page } from '../../layout/structs.ts';
import { stretchBound, type Vec3 } from '../../math/mat4.ts';
import { dispatchAtMost } from '../../stages/dispatch.ts';
import { keepColors } from '../../stages/keep-colors.ts';
import type { CloudPlan } from '../cloud-plan.ts';
import {
  type FramePage,
  firstPagesOf,
  PAGE_STRIDE_BYTES,
  pagesOf,
  projectWorkgroups,
} from '../frame-pages.ts';
import { type PartContext, useCompute } from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type CloudShape, type FrameShape, keepsColors, perShape } from '../frame-shape.ts';

/** The camera relative to a cloud, in the cloud's space: the cloud's colours depend on this and on its splats. */
interface Viewpoint {
  /** Position of the camera relative to the cloud's origin or, without perspective, the direction that it looks in. */
  readonly at: Vec3;
  readonly isDirection: boolean;
  /** Orientation of the cloud to the camera: cloud space to view space, column-major 3×3. */
  readonly linear: Float64Array;
  /** Viewpoints no further apart than this count as the same: their inputs are no more precise. */
  readonly tolerance: number;
}

/** Relative rounding of a viewpoint as the GPU receives it, and as the CPU computes it. */
const FLOAT32_TOLERANCE = 2 ** -22;
const FLOAT64_TOLERANCE = 2 ** -44;

/** Numbers of viewpoints fit into the 16 bits next to a colour in float16. */
const LAST_NUMBER = 0xffff;

/** The memory is freed after this many frames in a row that kept nothing: two seconds of moving about. */
const MAX_FRAMES_UNKEPT = 120;

/** The colours of one page. */
interface KeptPage {
  readonly buffer: GPUBuffer;
  /** Number of the viewpoint, from 1; entries with another number are invalid. 0 before the first: no entry is valid. */
  number: number;
}

/** Everything except the viewpoint that kept colours depend on, and where they are kept. */
interface Source {
  /** Index of the cloud's first page in the frame: if it changes, colours do not move along. */
  readonly firstPage: number;
  readonly planes: CloudShape['planes'];
  /** The cloud's, which edits change. */
  readonly version: number;
  readonly shDegree: number;
  readonly recordPrecision: AccuracySettings['recordPrecision'];
  readonly maxColor: number;
}

/** State of one cloud's colours after the last frame. */
interface KeptCloud {
  viewpoint: Viewpoint | null;
  source: Source;
  /** Whether the last frame kept its colours. */
  isKeeping: boolean;
  /** Whether the records of the last frame have the splats' own colours, unchanged by effects. */
  hasPlainRecords: boolean;
}

const stageOf = perShape(({ accuracy }) => keepColors(accuracy.recordPrecision));
const stagesOf = perShape((shape): readonly CompiledStage[] => (keepsColors(shape) ? [stageOf(shape)] : []));

/**
 * Keeps evaluated colours of splats, per view: while a cloud is seen from the same place, because the camera only turns or
 * only effects change, no splat's harmonics are evaluated twice. Views that never see a cloud twice from one place keep
 * nothing: the first colours are taken from the records of the last frame.
 */
export class KeptColors {
  readonly #context: PartContext;
  /** By page of the frame. */
  readonly #pages = new Map<number, KeptPage>();
  #clouds: KeptCloud[] = [];
  /** Frames in a row that kept nothing. */
  #framesUnkept = 0;

  constructor(context: PartContext) {
    this.#context = context;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return stagesOf(shape);
  }

  /** Bytes held on the GPU. */
  get bytes(): number {
    return [...this.#pages.values()].reduce((sum, { buffer }) => sum + buffer.size, 0);
  }

  /** Returns, per cloud, whether a frame of this plan should keep its colours. */
  wants(plan: FramePlan): boolean[] {
    return plan.clouds.map((cloud, i) => {
      // A forced frame exists to be timed, and stands in for one whose camera moved.
      if (plan.request.force || !canKeepColors(plan, i)) return false;
      // Effects may change while the camera stands still, and then the records have no plain colours to start from.
      if (hasHook(plan.shape.clouds[i].effects, 'color')) return true;
      const kept = this.#clouds[i];
      const viewpoint = viewpointOf(plan, cloud);
      // A new size or new settings alone are not worth the memory: they change once.
      return isSame(kept?.viewpoint, viewpoint) && (kept.isKeeping || isTurned(kept.viewpoint!, viewpoint!));
    });
  }

  /**
   * Makes room for the colours that a frame keeps, and frees the room that it does not need. Call for each frame, before its
   * buffers replace those of the last frame.
   *
   * No page exceeds the device's limits: its colours take at most 16 bytes per splat, and clouds are paged by at least 64.
   *
   * @returns the pages whose colours to take from the records of the last frame: see `record`.
   */
  keep(plan: FramePlan): readonly number[] {
    const { shape } = plan;
    const pages = pagesOf(shape);
    const firstPages = firstPagesOf(shape);
    const seeded: number[] = [];
    const next = plan.clouds.map((cloud, cloudIndex): KeptCloud => {
      const before = this.#clouds[cloudIndex];
      const viewpoint = viewpointOf(plan, cloud);
      const source = sourceOf(plan, cloudIndex, firstPages[cloudIndex]);
      const isKeeping = shape.clouds[cloudIndex].keepsColors;
      const hasPlainRecords =
        canKeepColors(plan, cloudIndex) && !hasHook(shape.clouds[cloudIndex].effects, 'color');
      const isValid =
        before !== undefined && isSameSource(before.source, source) && isSame(before.viewpoint, viewpoint);
      if (!isKeeping) {
        return {
          // The place is kept: updated every frame, it could drift in steps within its tolerance.
          viewpoint: isValid ? { ...before.viewpoint!, linear: viewpoint!.linear } : viewpoint,
          source,
          isKeeping,
          hasPlainRecords,
        };
      }
      if (isValid && before.isKeeping) return { ...before, hasPlainRecords };
      const isSeeded = isValid && before.hasPlainRecords;
      const first = firstPages[cloudIndex];
      for (let index = first; pages[index]?.cloudIndex === cloudIndex; index++) {
        this.#startOver(this.#pageFor(index, pages[index], shape.accuracy));
        if (isSeeded) seeded.push(index);
      }
      return { viewpoint, source, isKeeping, hasPlainRecords };
    });
    this.#clouds = next;
    this.#framesUnkept = keepsColors(shape) ? 0 : this.#framesUnkept + 1;
    this.#freeFrom(this.#framesUnkept > MAX_FRAMES_UNKEPT ? 0 : pages.length);
    this.#context.shared.keptColors = keepsColors(shape)
      ? pages.map((page, index) =>
          shape.clouds[page.cloudIndex].keepsColors
            ? this.#pageFor(index, page, shape.accuracy).buffer
            : null,
        )
      : [];
    return seeded;
  }

  /** Records taking the colours of these pages from the records of the last frame, whose shape is `shape`. */
  record(encoder: GPUCommandEncoder, shape: FrameShape, pageIndices: readonly number[]): void {
    const { pipelines, shared } = this.#context;
    const { buffers } = shared;
    const pages = pagesOf(shape);
    const stage = stageOf(shape);
    const pass = encoder.beginComputePass({ label: 'keep colors' });
    for (const index of pageIndices) {
      const group = pipelines.bindGroup(stage, {
        ...buffers,
        page: { buffer: buffers.pageUniforms, offset: index * PAGE_STRIDE_BYTES, size: Page.bytes },
        keptColors: this.#pageFor(index, pages[index], shape.accuracy).buffer,
      });
      useCompute(pass, pipelines, stage, group);
      const indirect = { buffer: buffers.projectDispatches, offset: 12 * index };
      dispatchAtMost(pass, projectWorkgroups(pages[index].chunkCount), shape.dispatchRow, indirect);
    }
    pass.end();
  }

  /** Returns the colours of one page, in a new buffer if the page has none of that size. */
  #pageFor(pageIndex: number, { splatCount }: FramePage, { recordPrecision }: AccuracySettings): KeptPage {
    const bytes = (recordPrecision === 'f32' ? 16 : 8) * (splatCount + 1);
    const current = this.#pages.get(pageIndex);
    if (current?.buffer.size === bytes) return current;
    const { memory } = this.#context;
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST;
    const page = { buffer: memory.createBuffer('frame kept colors', bytes, usage), number: 0 };
    if (current) memory.destroy(current.buffer);
    this.#pages.set(pageIndex, page);
    return page;
  }

  /** Frees the colours of this page and all later ones. */
  #freeFrom(pageIndex: number): void {
    for (const [index, { buffer }] of this.#pages) {
      if (index < pageIndex) continue;
      this.#context.memory.destroy(buffer);
      this.#pages.delete(index);
    }
  }

  #startOver(page: KeptPage): void {
    const { buffer } = page;
    const { queue } = this.#context.device;
    // Numbers start over: entries from the previous round would look valid. A new buffer has none.
    if (page.number === LAST_NUMBER) queue.writeBuffer(buffer, 0, new Uint8Array(buffer.size));
    page.number = (page.number % LAST_NUMBER) + 1;
    queue.writeBuffer(buffer, 0, Uint32Array.of(page.number));
  }
}

/** Whether a cloud has view-dependent colours that only the viewpoint changes. */
export function canKeepColors({ clouds, shape }: FramePlan, cloudIndex: number): boolean {
  const { shDegree, effects } = shape.clouds[cloudIndex];
  // Another view replaces the list of visible splats, which tells whose colour a record has.
  if (shape.order === 'taken') return false;
  if (shDegree === 0 || clouds[cloudIndex].reach.displacement > 0) return false;
  // This package's effects keep a splat's base colour; callers' effects might not.
  if (effects.effects.some((effect) => effect.hooks.splat && !CLOUD_EFFECTS.includes(effect))) return false;
  // Colours are kept in the format of the records: 8 bits up to 1 are too coarse as the input of an effect.
  return !(shape.accuracy.recordPrecision === 'paper' && hasHook(effects, 'color'));
}

function sourceOf({ clouds, shape }: FramePlan, cloudIndex: number, firstPage: number): Source {
  const { accuracy } = shape;
  const { planes, shDegree } = shape.clouds[cloudIndex];
  return {
    firstPage,
    planes,
    version: clouds[cloudIndex].version,
    shDegree,
    recordPrecision: accuracy.recordPrecision,
    maxColor: maxColor(accuracy),
  };
}

function isSameSource(a: Source, b: Source): boolean {
  return (
    a.firstPage === b.firstPage &&
    a.planes === b.planes &&
    a.version === b.version &&
    a.shDegree === b.shDegree &&
    a.recordPrecision === b.recordPrecision &&
    a.maxColor === b.maxColor
  );
}

const viewpoints = new WeakMap<CloudPlan, Viewpoint | null>();

/** Null if the model matrix is singular: there is no single viewpoint then. Cached, since each frame needs it twice. */
function viewpointOf(plan: FramePlan, cloud: CloudPlan): Viewpoint | null {
  let viewpoint = viewpoints.get(cloud);
  if (viewpoint === undefined) {
    viewpoint = findViewpoint(plan, cloud);
    viewpoints.set(cloud, viewpoint);
  }
  return viewpoint;
}

function findViewpoint({ camera: { viewMatrix } }: FramePlan, { view }: CloudPlan): Viewpoint | null {
  const { linear, inverse, camera, direction } = view;
  if (!inverse) return null;
  const at = camera ?? direction;
  // Near a cloud that is far from the world's origin, most digits of the position's terms cancel.
  const cancelled = stretchBound(inverse) * Math.hypot(viewMatrix[12], viewMatrix[13], viewMatrix[14]);
  const tolerance = FLOAT32_TOLERANCE * Math.hypot(at[0], at[1], at[2]) + FLOAT64_TOLERANCE * cancelled;
  return { at, isDirection: camera === null, linear, tolerance };
}

function isSame(a: Viewpoint | null | undefined, b: Viewpoint | null): boolean {
  if (!a || !b || a.isDirection !== b.isDirection) return false;
  const distance = Math.hypot(a.at[0] - b.at[0], a.at[1] - b.at[1], a.at[2] - b.at[2]);
  return distance <= Math.max(a.tolerance, b.tolerance);
}

function isTurned(before: Viewpoint, now: Viewpoint): boolean {
  return now.linear.some((value, i) => value !== before.linear[i]);
}
