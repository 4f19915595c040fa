import { type AccuracySettings, maxColor } from '../accuracy/accuracy.ts';
import type { Camera } from '../camera/camera.ts';
import { cloudView } from '../camera/cloud-view.ts';
import { hasHook } from '../effects/effect-set.ts';
import { CLOUD_EFFECTS, reachOf, usesOf } from '../effects/effects.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { identity4, invert3, stretchBound, type Vec3 } from '../math/mat4.ts';
import { numberOf } from '../number-of.ts';
import type { CloudInstance, ViewFrame } from './frame-request.ts';
import type { FramePage } from './frame-resources.ts';
import type { FrameShape } from './frame-shape.ts';

/** From where a cloud is seen, in its own space: what its colours depend on besides its splats. */
interface Viewpoint {
  /** Place of the camera about the cloud's origin or, without perspective, the direction that it looks in. */
  readonly at: Vec3;
  readonly isDirection: boolean;
  /** How the cloud is turned to the camera: cloud space to view space, column-major 3×3. */
  readonly linear: Float64Array;
  /** Viewpoints no further apart than this are the same: what they are computed from tells them no better. */
  readonly tolerance: number;
}

/** Part of the size of what a viewpoint is computed from: as it is told to the GPU, and as the CPU computes it. */
const FLOAT32_TOLERANCE = 2 ** -22;
const FLOAT64_TOLERANCE = 2 ** -44;

/** Numbers of viewpoints fit 16 bits beside a colour in float16. */
const LAST_NUMBER = 0xffff;

/** After so many frames that kept nothing, two seconds of moving about, what is held for it is freed. */
const MAX_FRAMES_UNKEPT = 120;

/** The colours of one page. */
interface KeptPage {
  readonly buffer: GPUBuffer;
  /** Of the viewpoint, from 1; entries with another number are of no use. 0 before the first: there are none. */
  number: number;
}

/** Whether colours of one cloud are kept, and of which viewpoint. */
interface KeptColors {
  viewpoint: Viewpoint | null;
  /** What else they depend on, and where they are. */
  source: string;
  /** Whether the last frame kept its colours. */
  isKeeping: boolean;
  /** Whether the records of the last frame have colours as they are seen, without effects that they depend on. */
  hasPlainRecords: boolean;
}

/**
 * Keeps the colours that splats have been evaluated with, per view: where a cloud is seen again from the same place, because
 * the camera only turned or only effects changed, no splat's harmonics are evaluated twice. Views that never see a cloud
 * twice from one place keep nothing: the first colours are taken from the records of the frame before.
 */
export class ColorCache {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  /** By page of the frame. */
  readonly #pages = new Map<number, KeptPage>();
  #clouds: KeptColors[] = [];
  /** Frames in a row that kept nothing. */
  #framesUnkept = 0;

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
  }

  /** What is held for it on the GPU. */
  get bytes(): number {
    return [...this.#pages.values()].reduce((sum, { buffer }) => sum + buffer.size, 0);
  }

  /** Of each cloud whether its colours are to be kept in a frame of this shape. */
  wants(frame: ViewFrame, shape: FrameShape): boolean[] {
    return frame.clouds.map((instance, i) => {
      // A frame that is drawn without a reason is there to be timed, and stands for one that has moved.
      if (frame.force || !canKeep(instance, shape, i)) return false;
      // Effects change while the camera stands still, and leave no plain colours in the records to begin with.
      if (hasHook(shape.effects[i], 'color')) return true;
      const kept = this.#clouds[i];
      const viewpoint = viewpointOf(frame.camera, instance, shape.isOrthographic);
      // Another size or other settings alone are not worth the memory: they come once.
      return isSame(kept?.viewpoint, viewpoint) && (kept.isKeeping || isTurned(kept.viewpoint!, viewpoint!));
    });
  }

  /** Where the colours of one page are kept, made where there is nothing that fits. */
  bufferOf(pageIndex: number, page: FramePage, accuracy: AccuracySettings): GPUBuffer {
    return this.#pageOf(pageIndex, page, accuracy).buffer;
  }

  /**
   * Call for each frame that is prepared, before it is recorded.
   *
   * @returns the pages whose colours are to be taken from the records of the frame before.
   */
  begin(frame: ViewFrame, shape: FrameShape, pages: readonly FramePage[]): readonly number[] {
    const seeded: number[] = [];
    const next = frame.clouds.map((instance, cloudIndex): KeptColors => {
      const before = this.#clouds[cloudIndex];
      const viewpoint = viewpointOf(frame.camera, instance, shape.isOrthographic);
      const firstPage = pages.findIndex((page) => page.cloudIndex === cloudIndex);
      const source = sourceOf(shape, cloudIndex, firstPage);
      const isKeeping = shape.keepsColors[cloudIndex];
      const hasPlainRecords =
        canKeep(instance, shape, cloudIndex) && !hasHook(shape.effects[cloudIndex], 'color');
      const isValid = before?.source === source && isSame(before.viewpoint, viewpoint);
      if (!isKeeping) {
        return {
          // The place stays, lest it creeps away within its tolerance.
          viewpoint: isValid ? { ...before.viewpoint!, linear: viewpoint!.linear } : viewpoint,
          source,
          isKeeping,
          hasPlainRecords,
        };
      }
      if (isValid && before.isKeeping) return { ...before, hasPlainRecords };
      const isSeeded = isValid && before.hasPlainRecords;
      for (const [index, page] of pages.entries()) {
        if (page.cloudIndex !== cloudIndex) continue;
        this.#startOver(this.#pageOf(index, page, shape.accuracy));
        if (isSeeded) seeded.push(index);
      }
      return { viewpoint, source, isKeeping, hasPlainRecords };
    });
    this.#clouds = next;
    this.#framesUnkept = shape.keepsColors.includes(true) ? 0 : this.#framesUnkept + 1;
    this.#freeFrom(this.#framesUnkept > MAX_FRAMES_UNKEPT ? 0 : pages.length);
    return seeded;
  }

  destroy(): void {
    this.#freeFrom(0);
  }

  #pageOf(pageIndex: number, { splatCount }: FramePage, { recordPrecision }: AccuracySettings): KeptPage {
    const bytes = (recordPrecision === 'f32' ? 16 : 8) * (splatCount + 1);
    const current = this.#pages.get(pageIndex);
    if (current?.buffer.size === bytes) return current;
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST;
    const page = { buffer: this.#memory.createBuffer('frame kept colors', bytes, usage), number: 0 };
    if (current) this.#memory.destroy(current.buffer);
    this.#pages.set(pageIndex, page);
    return page;
  }

  /** Frees what is kept of this page and those behind it. */
  #freeFrom(pageIndex: number): void {
    for (const [index, { buffer }] of this.#pages) {
      if (index < pageIndex) continue;
      this.#memory.destroy(buffer);
      this.#pages.delete(index);
    }
  }

  #startOver(page: KeptPage): void {
    const { buffer } = page;
    // Entries as old as that would look like new ones; a new buffer has none.
    if (page.number === LAST_NUMBER) this.#queue.writeBuffer(buffer, 0, new Uint8Array(buffer.size));
    page.number = (page.number % LAST_NUMBER) + 1;
    this.#queue.writeBuffer(buffer, 0, Uint32Array.of(page.number));
  }
}

/** Whether there is anything to keep, and nothing but the place that it is seen from changes it. */
export function canKeep(instance: CloudInstance, shape: FrameShape, cloudIndex: number): boolean {
  if (shape.shDegrees[cloudIndex] === 0 || reachOf(usesOf(instance)).displacement > 0) return false;
  const set = shape.effects[cloudIndex];
  // Effects of this package leave a splat's base colour as it is; of those of callers' own nothing is known.
  if (set.effects.some((effect) => effect.hooks.splat && !CLOUD_EFFECTS.includes(effect))) return false;
  // Colours are kept as records have them: at 8 bits and up to 1 that is too little for an effect to begin with.
  return !(shape.accuracy.recordPrecision === 'paper' && hasHook(set, 'color'));
}

/** @param firstPage index of the cloud's first page in the frame: colours do not move along with it. */
function sourceOf(shape: FrameShape, cloudIndex: number, firstPage: number): string {
  const { accuracy, planes, shDegrees } = shape;
  return [
    firstPage,
    numberOf(planes[cloudIndex]),
    shDegrees[cloudIndex],
    accuracy.recordPrecision,
    maxColor(accuracy),
  ].join(' ');
}

/** Null where the model matrix cannot be inverted: nothing is known of what is seen then. */
function viewpointOf(
  { viewMatrix }: Camera,
  { cloud, modelMatrix = identity4() }: CloudInstance,
  isOrthographic: boolean,
): Viewpoint | null {
  const { linear, camera, direction } = cloudView(viewMatrix, modelMatrix, cloud.origin, isOrthographic);
  const inverse = invert3(linear);
  if (!inverse) return null;
  const at = camera ?? direction;
  // Near a cloud that is far from the world's origin, most of what the place is computed from cancels.
  const cancelled = stretchBound(inverse) * Math.hypot(viewMatrix[12], viewMatrix[13], viewMatrix[14]);
  const tolerance = FLOAT32_TOLERANCE * Math.hypot(...at) + FLOAT64_TOLERANCE * cancelled;
  return { at, isDirection: camera === null, linear, tolerance };
}

function isSame(a: Viewpoint | null | undefined, b: Viewpoint | null): boolean {
  if (!a || !b || a.isDirection !== b.isDirection) return false;
  return Math.hypot(...a.at.map((value, axis) => value - b.at[axis])) <= Math.max(a.tolerance, b.tolerance);
}

function isTurned(before: Viewpoint, now: Viewpoint): boolean {
  return now.linear.some((value, i) => value !== before.linear[i]);
}
