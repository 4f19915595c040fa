import { CompositeParameters } from '../../data/layout/structs.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { composite, compositeInCompute, compositeState } from '../../stages/composite/composite.ts';
import {
  computeOverAll,
  type DrawRecording,
  drawOverAll,
  type FramePart,
  type PartChange,
  type PartContext,
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

  record({ encoder, timer, shape, destination }: DrawRecording): void {
    const stage = stageOf(shape);
    if (destination.kind !== 'canvas' || !stage) return;
    const { canvas, background } = destination;
    const { device, pipelines } = this.#context;
    const contents = CompositeParameters.pack({ background });
    device.queue.writeBuffer(this.#parameters!, 0, contents);
    const target = canvas.getCurrentTexture();
    const timestampWrites = timer.writes('composite');
    if (stage.compute) {
      const pass = encoder.beginComputePass({ label: 'composite', timestampWrites });
      // A canvas has another texture in every frame.
      const group = pipelines.bindGroup(stage.compute, {
        parameters: this.#parameters!,
        layer: this.#context.shared.image!.color.createView(),
        canvas: target.createView(),
      });
      computeOverAll(pass, pipelines, stage.compute, group, target);
      pass.end();
      return;
    }
    const pass = encoder.beginRenderPass({
      label: 'composite',
      colorAttachments: [{ view: target.createView(), loadOp: 'clear', storeOp: 'store' }],
      timestampWrites,
    });
    drawOverAll(pass, pipelines, stage.render, this.#group!);
    pass.end();
  }
}
