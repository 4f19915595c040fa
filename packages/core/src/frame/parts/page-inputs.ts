import type { FrustumSide } from '../../data/camera/frustum.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import type { GpuValues } from '../../data/layout/gpu-struct.ts';
import { Page, View } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings } from '../../gpu/pipelines.ts';
import { type FramePage, pagesOf, uniformBytes } from '../frame-pages.ts';
import type { CloudPlace, CloudPlan } from '../plan/cloud-plan.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import { type FrameShape, hasSameBuffers } from '../plan/frame-shape.ts';
import { CutBuffers } from './cut-buffers.ts';
import { EffectBuffers } from './effect-buffers.ts';
import { createBuffers, type FramePart, type PartChange, type PartContext } from './frame-part.ts';
import { WidePlaces } from './wide-places.ts';

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

/** Returns the contents of a frame's `view` buffer. */
function viewUniforms({ projection, shape }: FramePlan): ArrayBuffer {
  const { widthPx, heightPx, focalPx, centerPx, clampX, clampY, near, far } = projection;
  return View.pack({
    sizePx: [widthPx, heightPx],
    focalPx,
    centerPx,
    clampX,
    clampY,
    near,
    // Shaders may assume that there are no infinities; the largest float32 does the same.
    far: Math.min(far, 3.4028234663852886e38),
    alphaCutoff: shape.accuracy.alphaCutoff,
    dispatchRow: shape.dispatchRow,
  });
}

/**
 * Writes the contents of a frame's `pageUniforms` buffer.
 *
 * @param contents `uniformBytes` of the pages; reused for every frame, since allocating memory of
 *   this size is slow.
 */
function writePageUniforms({ clouds, shape }: FramePlan, contents: ArrayBuffer): void {
  const bytes = new Uint8Array(contents);
  const words = new Uint32Array(contents);
  let first: FramePage | null = null;
  for (const [index, page] of pagesOf(shape).entries()) {
    const { cloudIndex, batchIndex, uniform, instances, chunksEach } = page;
    const cloud = clouds[cloudIndex];
    const cellCount = shape.clouds[cloudIndex].levels?.cellCount ?? 0;
    const count = instances?.count ?? 1;
    if (first?.cloudIndex === cloudIndex && first.batchIndex === batchIndex) {
      bytes.copyWithin(uniform.offset, first.uniform.offset, first.uniform.offset + uniform.size);
    } else {
      first = page;
      for (let i = 0; i < count; i++) {
        const place = instances ? cloud.places![instances.first + i] : cloud;
        Page.write(
          contents,
          placeValues(place, cloud.dilationPx2, i * cellCount),
          uniform.offset + i * Page.bytes,
        );
      }
      // Clears the rest of the batch, which may hold another frame's pages.
      bytes.fill(0, uniform.offset + count * Page.bytes, uniform.offset + uniform.size);
    }
    for (let i = 0; i < count; i++) {
      const start = (uniform.offset + i * Page.bytes) / 4;
      words[start + Page.offsets.index / 4] = index;
      words[start + Page.offsets.chunkStart / 4] = page.chunkStart + i * chunksEach;
      words[start + Page.offsets.chunkCount / 4] = chunksEach;
      words[start + Page.offsets.splatCount / 4] = page.splatCount;
    }
  }
}

/** Fields that all pages of a place have in common; the others are 0. */
function placeValues(
  { view, sides }: CloudPlace,
  dilationPx2: number,
  cellStart: number,
): GpuValues<typeof Page.fields> {
  return {
    linear: view.linear,
    translation: view.translation,
    dilationPx2,
    camera: view.camera ?? ORIGIN,
    cameraWeight: view.camera ? 1 : 0,
    sight: view.sight,
    direction: view.direction,
    cellStart,
    ...packedSides(sides),
    index: 0,
    chunkStart: 0,
    chunkCount: 0,
    splatCount: 0,
  };
}

const ORIGIN = [0, 0, 0] as const;

function packedSides(sides: readonly FrustumSide[]) {
  return {
    frustum: fourEach(sides, ({ normal, offset }, into, at) => {
      into[at] = normal[0];
      into[at + 1] = normal[1];
      into[at + 2] = normal[2];
      into[at + 3] = offset;
    }),
    frustumReach: fourEach(sides, ({ reach }, into, at) => {
      into[at] = reach;
    }),
  };
}

/** Collects four numbers per side. */
function fourEach(
  sides: readonly FrustumSide[],
  fill: (side: FrustumSide, into: number[], at: number) => void,
): number[] {
  const numbers = new Array<number>(4 * sides.length).fill(0);
  for (let i = 0; i < sides.length; i++) fill(sides[i], numbers, 4 * i);
  return numbers;
}
