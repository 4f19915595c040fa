import type { RenderPass } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { resolveDepth, resolveDepthState } from '../../stages/compose/compose.ts';
import { TESTED_DEPTH_FORMAT } from '../../stages/quads/quads.ts';
import { type Drawing, type FramePart, OVER_ALL, type PartContext } from '../frame-part.ts';
import { type FrameShape, isScaled, perShape } from '../frame-shape.ts';
import { depthView, HostGroup, isMultisampled } from '../host-textures.ts';

/**
 * Two variants: whether the host's depth has several samples is known only when the frame is drawn.
 * Null if no depth is tested.
 */
const stageOf = perShape((shape) => {
  const { depth, output } = shape;
  if (!depth?.isTested || output.kind !== 'host') return null;
  const variant = (isMany: boolean) =>
    [resolveDepth(depth.compare, isMany, isScaled(shape)), resolveDepthState] as const;
  return { single: variant(false), many: variant(true) };
});

/**
 * Copies the host's depth, for splats to be tested against: it may be multisampled, larger, or in
 * another format.
 */
export class ResolveDepth implements FramePart {
  readonly #context: PartContext;
  #depth: GPUTexture | null = null;
  readonly #group = new HostGroup();

  constructor(context: PartContext) {
    this.#context = context;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return Object.values(stageOf(shape) ?? {});
  }

  /** Bytes of the copy. */
  get bytes(): number {
    return this.#context.memory.bytesOf(this.#depth);
  }

  bind(): void {
    this.#group.clear();
  }

  /** Null, and no copy is kept, if no depth of a host is tested. */
  pass({ shape, destination }: Drawing): RenderPass | null {
    const stages = stageOf(shape);
    if (!stages || destination.kind !== 'host') {
      this.#leave();
      return null;
    }
    const { pipelines, shared } = this.#context;
    const target = this.#textureFor(shared.blended!.color);
    const { pass: host } = destination;
    const stage = isMultisampled(host) ? stages.many : stages.single;
    const depthStencilAttachment = {
      view: target.createView(),
      depthLoadOp: 'clear',
      depthStoreOp: 'store',
      depthClearValue: 0,
    } as const;
    return {
      label: 'resolve depth',
      timed: 'resolve-depth',
      targets: { colorAttachments: [], depthStencilAttachment },
      pipeline: pipelines.render(...stage)!,
      // Both variants of the stage follow from the depth.
      group: this.#group.for([host.depth, host.layer], () =>
        pipelines.bindGroup(stage[0], { viewport: shared.viewport!, hostDepths: depthView(host) }),
      ),
      draws: OVER_ALL,
    };
  }

  #leave(): void {
    const { memory, shared } = this.#context;
    if (this.#depth) memory.destroy(this.#depth);
    this.#depth = null;
    shared.testedDepth = null;
  }

  /** Made here and not in `fit`: until a frame is drawn, the host may show the last one. */
  #textureFor({ width, height }: GPUTexture): GPUTexture {
    if (this.#depth?.width === width && this.#depth.height === height) return this.#depth;
    this.#leave();
    const { memory, shared } = this.#context;
    this.#depth = memory.createTarget('depth of the host', TESTED_DEPTH_FORMAT, { width, height });
    shared.testedDepth = this.#depth;
    return this.#depth;
  }
}
