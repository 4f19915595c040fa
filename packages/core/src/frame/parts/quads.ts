import { HostDepth } from '../../data/layout/structs.ts';
import type { DrawSize, RenderPass } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import type { TimedPass } from '../../gpu/timing/frame-statistics.ts';
import { type DepthLayerFormat, rasterize, rasterizeState } from '../../stages/quads/quads.ts';
import type { Drawing, FramePart, LayerTextures, PartChange, PartContext } from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, isScaled, perShape } from '../frame-shape.ts';
import { hostDepthUniform } from '../frame-uniforms.ts';
import { createLayer, fitsLayer, freeLayer } from '../layer-textures.ts';

/** The stage that draws the visible splats, and the targets that it draws into. */
const stageOf = perShape(({ accuracy, depth, isStacked }) => {
  const { recordPrecision, extent, colorTarget } = accuracy;
  return [
    rasterize({ recordPrecision, extent, depth, isStacked }),
    rasterizeState(colorTarget, depth),
  ] as const;
});

/** Places of the order that a sample takes splats from: near ones are larger than far ones. */
const SAMPLED_PLACES = 16;

/** Blends the visible splats in order, one instanced quad each, into a layer of its own. */
export class Quads implements FramePart {
  readonly #context: PartContext;
  #layer: LayerTextures | null = null;
  /** One `HostDepth`, for shapes with depth. */
  #hostDepth: GPUBuffer | null = null;
  #group: GPUBindGroup | null = null;

  constructor(context: PartContext) {
    this.#context = context;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return [stageOf(shape)];
  }

  fit({ layer, shape }: FramePlan): PartChange | null {
    const { memory } = this.#context;
    const { colorTarget } = shape.accuracy;
    const depthFormat: DepthLayerFormat | null = shape.depth?.layerFormat ?? null;
    // Tiles write the same layer.
    const usage = shape.rasterizer === 'tiles' ? GPUTextureUsage.STORAGE_BINDING : 0;
    const keepsLayer = fitsLayer(this.#layer, layer, colorTarget, depthFormat, usage);
    const keepsDepth = (this.#hostDepth !== null) === (shape.depth !== null);
    if (keepsLayer && keepsDepth) return null;
    return {
      // The frame's size was checked before.
      free: () => {
        if (!keepsLayer) freeLayer(memory, this.#layer);
        if (!keepsDepth && this.#hostDepth) memory.destroy(this.#hostDepth);
      },
      make: () => {
        if (!keepsLayer) {
          const label = isScaled(shape) ? 'small splat layer' : 'splat layer';
          this.#layer = createLayer(memory, label, layer, colorTarget, depthFormat, usage);
        }
        if (!keepsDepth) {
          const flags = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
          this.#hostDepth = shape.depth && memory.createBuffer('frame hostDepth', HostDepth.bytes, flags);
        }
        const { shared } = this.#context;
        shared.blended = this.#layer;
        shared.hostDepth = this.#hostDepth;
      },
    };
  }

  bind(shape: FrameShape): void {
    const { pipelines, shared } = this.#context;
    const { buffers } = shared;
    this.#group = pipelines.bindGroup(stageOf(shape)[0], {
      ...buffers,
      ...(this.#hostDepth && { hostDepth: this.#hostDepth }),
    });
  }

  write(plan: FramePlan): void {
    const { depth } = plan.shape;
    if (!this.#hostDepth || !depth) return;
    this.#context.device.queue.writeBuffer(this.#hostDepth, 0, hostDepthUniform(plan, depth.mapping));
  }

  pass(shape: FrameShape): RenderPass {
    const indirect = { buffer: this.#context.shared.buffers.drawArguments, offset: 0 };
    return this.#pass(shape, 'rasterize', 'rasterize', [indirect]);
  }

  /** Draws some quads, spread over their order, to be timed. The layer is overwritten. */
  samplePass({ shape, sample }: Drawing): RenderPass | null {
    if (!sample || shape.rasterizer !== 'tiles') return null;
    const { share, visibleSplats } = sample;
    const count = share * visibleSplats;
    // None for a share of none: drawing no instance is warned about.
    const places = Math.min(SAMPLED_PLACES, Math.ceil(count));
    const each = Math.ceil(count / places);
    const draws = Array.from({ length: places }, (_, i) => {
      const first = Math.floor(((i + 0.5) / places) * visibleSplats - each / 2);
      return [4, each, 0, Math.max(0, first)] as const;
    });
    return this.#pass(shape, 'quads sample', 'quads-sample', draws);
  }

  #pass(shape: FrameShape, label: string, timed: TimedPass, draws: readonly DrawSize[]): RenderPass {
    const { pipelines, shared } = this.#context;
    const { color, depthLayer } = this.#layer!;
    const { testedDepth } = shared;
    const targets = {
      colorAttachments: [color, depthLayer]
        .filter((texture) => texture !== null)
        .map((texture) => ({
          view: texture.createView(),
          // Tiles have written every pixel. Clearing takes longer than all their stages.
          loadOp: shape.rasterizer === 'tiles' ? ('load' as const) : ('clear' as const),
          storeOp: 'store' as const,
          clearValue: [0, 0, 0, 0],
        })),
      ...(testedDepth && {
        depthStencilAttachment: { view: testedDepth.createView(), depthReadOnly: true },
      }),
    };
    return {
      label,
      timed,
      targets,
      pipeline: pipelines.render(...stageOf(shape))!,
      group: this.#group!,
      draws,
    };
  }
}
