import { roundUp } from '../../data/layout/gpu-struct.ts';
import { Page } from '../../data/layout/structs.ts';
import { WidePlace, writeWidePlace } from '../../data/layout/wide-place.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings } from '../../gpu/pipelines.ts';
import { BINDING_ALIGNMENT, pagesOf, type UniformRange, uniformBytes } from '../frame-pages.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import { type FrameShape, hasWideKeys, perShape } from '../plan/frame-shape.ts';

/** By page of the frame: where its places in float64 lie. */
const rangesOf = perShape((shape: FrameShape): readonly UniformRange[] => {
  let end = 0;
  return pagesOf(shape).map(({ uniform, instances }) => {
    // As many as there is room for in the page's uniforms.
    const places = instances ? Math.floor(uniform.size / Page.bytes) : 1;
    const range = { offset: end, size: WidePlace.bytes * places };
    end = roundUp(end + range.size, BINDING_ALIGNMENT);
    return range;
  });
});

/** Places of a frame's pages in float64, for wide keys; nothing without such keys. */
export class WidePlaces {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  #buffer: GPUBuffer | null = null;
  #ranges: readonly UniformRange[] = [];
  #contents = new ArrayBuffer(0);

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
  }

  /** Makes room for the pages of this shape, and frees the rest. */
  fit(shape: FrameShape): void {
    this.#ranges = hasWideKeys(shape) ? rangesOf(shape) : [];
    const bytes = uniformBytes(this.#ranges);
    if ((this.#buffer?.size ?? 0) === bytes) return;
    if (this.#buffer) this.#memory.destroy(this.#buffer);
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.#buffer = bytes > 0 ? this.#memory.createBuffer('frame wide places', bytes, usage) : null;
    this.#contents = new ArrayBuffer(bytes);
  }

  /** Returns the bindings of one page's stages. */
  bindingsOf(pageIndex: number): Bindings {
    return this.#buffer ? { widePlaces: { buffer: this.#buffer, ...this.#ranges[pageIndex] } } : {};
  }

  write({ clouds, shape, farthestHigh }: FramePlan): void {
    if (!this.#buffer) return;
    for (const [index, { cloudIndex, instances }] of pagesOf(shape).entries()) {
      const cloud = clouds[cloudIndex];
      for (let i = 0; i < (instances?.count ?? 1); i++) {
        const { view } = instances ? cloud.places![instances.first + i] : cloud;
        const at = this.#ranges[index].offset + i * WidePlace.bytes;
        writeWidePlace(this.#contents, view, farthestHigh, at);
      }
    }
    this.#queue.writeBuffer(this.#buffer, 0, this.#contents);
  }
}
