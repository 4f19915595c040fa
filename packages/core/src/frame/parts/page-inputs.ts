import { hasSameFields } from '../../data/has-same-fields.ts';
import { View } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings } from '../../gpu/pipelines.ts';
import type { CloudPlan } from '../cloud-plan.ts';
import { CutBuffers } from '../cut-buffers.ts';
import { EffectBuffers } from '../effect-buffers.ts';
import { pagesOf, uniformBytes } from '../frame-pages.ts';
import { createBuffers, type FramePart, type PartChange, type PartContext } from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, hasSameBuffers } from '../frame-shape.ts';
import { viewUniforms, writePageUniforms } from '../frame-uniforms.ts';
import { WidePlaces } from '../wide-places.ts';

/**
 * Inputs of the stages that run over pages: the view, and each page's uniforms, parameters of
 * effects, cuts and places.
 */
export class PageInputs implements FramePart {
  readonly effects: EffectBuffers;
  readonly #context: PartContext;
  readonly #memory: GpuMemory;
  readonly #cuts: CutBuffers;
  readonly #widePlaces: WidePlaces;
  /** The shape that the buffers were made for. */
  #shape: FrameShape | null = null;
  #contents = new ArrayBuffer(0);
  /** By cloud of the frame: the resources that its effects have of their own. */
  #resources: readonly Bindings[] = [];

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
    this.effects = new EffectBuffers(context.memory, context.device.queue);
    this.#cuts = new CutBuffers(context);
    this.#widePlaces = new WidePlaces(context.memory, context.device.queue);
  }

  fit({ shape, clouds }: FramePlan): PartChange | null {
    const resources = clouds.map(resourcesOf);
    const isBound = resources.every((each, i) => hasSameFields(each, this.#resources[i] ?? {}));
    const isSized = this.#shape !== null && hasSameBuffers(this.#shape, shape);
    if (isSized && isBound) return null;
    return {
      free: () => {
        if (!isSized) this.#memory.destroyAll();
      },
      make: () => {
        this.#resources = resources;
        if (isSized) return;
        const { UNIFORM } = GPUBufferUsage;
        const bytes = uniformBytes(pagesOf(shape).map(({ uniform }) => uniform));
        const buffers = createBuffers(this.#memory, 'frame', {
          view: [View.bytes, UNIFORM],
          pageUniforms: [bytes, UNIFORM],
        });
        Object.assign(this.#context.shared.resources, buffers);
        this.#contents = new ArrayBuffer(bytes);
        this.#shape = shape;
      },
    };
  }

  bind(shape: FrameShape): void {
    const { shared } = this.#context;
    this.effects.fit(shape);
    this.#cuts.fit(shape);
    this.#widePlaces.fit(shape);
    const { resources } = shared;
    shared.batches = this.#cuts.batches(shape);
    shared.pages = pagesOf(shape).map((page, index) => ({
      cloudIndex: page.cloudIndex,
      isBlobs: page.isBlobs,
      count: page.chunkCount,
      resources: {
        ...resources,
        [page.instances ? 'pages' : 'page']: { buffer: resources.pageUniforms, ...page.uniform },
        chunks: page.chunks,
        geometry: page.geometry,
        shRest: page.shRest,
        ...this.#cuts.bindingsOf(page),
        ...this.#widePlaces.bindingsOf(index),
      },
      effects: {
        ...(page.motion && { motion: page.motion.splats, motionReaches: page.motion.reaches }),
        ...this.effects.bindingsOf(index),
        ...this.#resources[page.cloudIndex],
      },
    }));
  }

  write(plan: FramePlan): void {
    const { device, shared } = this.#context;
    const { view, pageUniforms } = shared.resources;
    device.queue.writeBuffer(view, 0, viewUniforms(plan));
    writePageUniforms(plan, this.#contents);
    // Deno 2.9 ends at a write of no bytes.
    if (this.#contents.byteLength > 0) device.queue.writeBuffer(pageUniforms, 0, this.#contents);
    this.effects.write(plan);
    this.#cuts.write(plan, shared.pages);
    this.#widePlaces.write(plan);
  }
}

/** Resources of a cloud's effects by the names that shaders bind them by. */
function resourcesOf({ uses }: CloudPlan): Bindings {
  const bound: Record<string, Bindings[string]> = {};
  for (const { resources } of uses) for (const { name, binding } of resources) bound[name] = binding;
  return bound;
}
