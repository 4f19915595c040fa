import { type AccuracySettings, maxColor } from './accuracy.ts';
import type { Camera } from './camera.ts';
import { hasHook } from './effects/effect-set.ts';
import { reachOf, usesOf } from './effects/effects.ts';
import type { FramePage } from './frame-resources.ts';
import type { FrameShape } from './frame-shape.ts';
import type { GpuMemory } from './gpu/gpu-memory.ts';
import { identity4, invert3, stretchBound, type Vec3 } from './math/mat4.ts';
import { numberOf } from './number-of.ts';
import { cloudView } from './scene/cloud-view.ts';
import type { CloudInstance, ViewFrame } from './scene/view-frame.ts';

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

/** What colours of one cloud are kept, and of which viewpoint. */
interface KeptColors {
  viewpoint: Viewpoint | null;
  /** What else they depend on. */
  source: string;
  /** Of the viewpoint, from 1; entries with another number are of no use. */
  number: number;
  /** Whether the last frame kept its colours. */
  isKeeping: boolean;
  /** Whether the records of the last frame have colours as they are seen, without effects on them. */
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
  readonly #buffers = new Map<number, GPUBuffer>();
  #clouds: KeptColors[] = [];

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
  }

  /** What is held for it on the GPU. */
  get bytes(): number {
    return [...this.#buffers.values()].reduce((sum, { size }) => sum + size, 0);
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
  bufferOf(pageIndex: number, { splatCount }: FramePage, { recordPrecision }: AccuracySettings): GPUBuffer {
    const bytes = (recordPrecision === 'f32' ? 16 : 8) * (splatCount + 1);
    const current = this.#buffers.get(pageIndex);
    if (current?.size === bytes) return current;
    if (current) this.#memory.destroy(current);
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST;
    const buffer = this.#memory.createBuffer('frame kept colors', bytes, usage);
    this.#buffers.set(pageIndex, buffer);
    return buffer;
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
      const source = sourceOf(shape, cloudIndex);
      const isKeeping = shape.keepsColors[cloudIndex];
      const hasPlainRecords = !hasHook(shape.effects[cloudIndex], 'color');
      const isValid = before?.source === source && isSame(before.viewpoint, viewpoint);
      if (!isKeeping) {
        const number = before?.number ?? 0;
        return {
          // The place stays, lest it creeps away within its tolerance.
          viewpoint: isValid ? { ...before.viewpoint!, linear: viewpoint!.linear } : viewpoint,
          source,
          number,
          isKeeping,
          hasPlainRecords,
        };
      }
      if (isValid && before.isKeeping) return { ...before, hasPlainRecords };
      const number = ((before?.number ?? 0) % LAST_NUMBER) + 1;
      const isSeeded = isValid && before.hasPlainRecords;
      for (const [index, page] of pages.entries()) {
        if (page.cloudIndex !== cloudIndex) continue;
        this.#startOver(this.bufferOf(index, page, shape.accuracy), number);
        if (isSeeded) seeded.push(index);
      }
      return { viewpoint, source, number, isKeeping, hasPlainRecords };
    });
    this.#clouds = next;
    this.#freeBeyond(pages);
    return seeded;
  }

  destroy(): void {
    for (const buffer of this.#buffers.values()) this.#memory.destroy(buffer);
    this.#buffers.clear();
  }

  /** Frees what is kept of pages that there are no longer. */
  #freeBeyond(pages: readonly FramePage[]): void {
    for (const [index, buffer] of this.#buffers) {
      if (index < pages.length) continue;
      this.#memory.destroy(buffer);
      this.#buffers.delete(index);
    }
  }

  #startOver(buffer: GPUBuffer, number: number): void {
    // Entries as old as that would look like new ones.
    if (number === 1) this.#queue.writeBuffer(buffer, 0, new Uint8Array(buffer.size));
    this.#queue.writeBuffer(buffer, 0, Uint32Array.of(number));
  }
}

/** Whether there is anything to keep, and splats stay where they are seen. */
export function canKeep(instance: CloudInstance, shape: FrameShape, cloudIndex: number): boolean {
  return shape.shDegrees[cloudIndex] > 0 && reachOf(usesOf(instance)).displacement === 0;
}

function sourceOf(shape: FrameShape, cloudIndex: number): string {
  const { accuracy, planes, shDegrees } = shape;
  return [
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
