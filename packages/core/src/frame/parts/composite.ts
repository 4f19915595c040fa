import { CompositeParameters } from '../../data/layout/structs.ts';
import { dispatchOf, type FramePass } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { composite, compositeInCompute, compositeState } from '../../stages/composite/composite.ts';
import {
  type Destination,
  type FramePart,
  OVER_ALL,
  type PartChange,
  type PartContext,
  sizeOverImage,
} from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, perShape } from '../frame-shape.ts';

/** Stages that put the splats on the canvas; a frame runs one. Null without a canvas. */
const stageOf = perShape(({ output, rasterizer }) => {
  if (output.kind !== 'canvas') return null;
  if (rasterizer === 'tiles' && output.storable) return { compute: compositeInCompute(output.storable) };
  return { render: [composite, compositeState(output.format)] as const };
});

/** Draws the splats over the background, on a canvas. */
export class Composite implements FramePart {
  readonly #context: PartContext;
  #parameters: GPUBuffer | null = null;
  #group: GPUBindGroup | null = null;

  constructor(context: PartContext) {
    this.#context = context;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    const stage = stageOf(shape);
    return stage ? [stage.compute ?? stage.render] : [];
  }

  fit({ shape }: FramePlan): PartChange | null {
    if (shape.output.kind !== 'canvas' || this.#parameters) return null;
    const { memory } = this.#context;
    return {
      free: () => {},
      make: () => {
        const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
        this.#parameters = memory.createBuffer('composite parameters', CompositeParameters.bytes, usage);
      },
    };
  }

  bind(shape: FrameShape): void {
    const { pipelines, shared } = this.#context;
    const stage = stageOf(shape);
    this.#group =
      this.#parameters && stage?.render
        ? pipelines.bindGroup(composite, {
            parameters: this.#parameters,
            layer: shared.image!.color.createView(),
          })
        : null;
  }

  /** Null unless the destination is a canvas. */
  pass(shape: FrameShape, destination: Destination): FramePass | null {
    const stage = stageOf(shape);
    if (destination.kind !== 'canvas' || !stage) return null;
    const { canvas, background } = destination;
    const { device, pipelines, shared } = this.#context;
    const contents = CompositeParameters.pack({ background });
    device.queue.writeBuffer(this.#parameters!, 0, contents);
    const target = canvas.getCurrentTexture();
    const named = { label: 'composite', timed: 'composite' } as const;
    if (stage.compute) {
      // A canvas has another texture in every frame.
      const resources = {
        parameters: this.#parameters!,
        layer: shared.image!.color.createView(),
        canvas: target.createView(),
      };
      return {
        ...named,
        dispatches: [dispatchOf(pipelines, stage.compute, resources, sizeOverImage(target))],
      };
    }
    return {
      ...named,
      targets: { colorAttachments: [{ view: target.createView(), loadOp: 'clear', storeOp: 'store' }] },
      pipeline: pipelines.render(...stage.render)!,
      group: this.#group!,
      draws: OVER_ALL,
    };
  }
}
