import type { CompiledStage } from '../../gpu/pipelines.ts';
import { CompositeParameters } from '../../layout/structs.ts';
import { composite, compositeState } from '../../stages/composite.ts';
import {
  type DrawRecording,
  drawOverAll,
  type FramePart,
  type PartChange,
  type PartContext,
} from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, perShape } from '../frame-shape.ts';

/** The stage that draws the splats to the canvas; null for frames without a canvas. */
const stageOf = perShape(({ output }) =>
  output.kind === 'canvas' ? ([composite, compositeState(output.format)] as const) : null,
);

const stagesOf = perShape((shape): readonly CompiledStage[] => {
  const stage = stageOf(shape);
  return stage ? [stage] : [];
});

/** Draws the splats over the background, on a canvas. */
export class Composite implements FramePart<DrawRecording> {
  readonly #context: PartContext;
  #parameters: GPUBuffer | null = null;
  #group: GPUBindGroup | null = null;

  constructor(context: PartContext) {
    this.#context = context;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return stagesOf(shape);
  }

  fit({ shape }: FramePlan): PartChange | null {
    if (shape.output.kind !== 'canvas' || this.#parameters) return null;
    const { memory } = this.#context;
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    const parameters = memory.createBuffer('composite parameters', CompositeParameters.bytes, usage);
    return {
      commit: () => {
        this.#parameters = parameters;
      },
      discard: () => memory.destroy(parameters),
    };
  }

  bind(): void {
    const { pipelines, shared } = this.#context;
    this.#group =
      this.#parameters &&
      pipelines.bindGroup(composite, {
        parameters: this.#parameters,
        layer: shared.image!.color.createView(),
      });
  }

  record({ encoder, timer, shape, destination }: DrawRecording): void {
    const stage = stageOf(shape);
    if (destination.kind !== 'canvas' || !stage) return;
    const { canvas, background } = destination;
    const { device, pipelines } = this.#context;
    const contents = CompositeParameters.pack({ background });
    device.queue.writeBuffer(this.#parameters!, 0, contents);
    const pass = encoder.beginRenderPass({
      label: 'composite',
      colorAttachments: [
        { view: canvas.getCurrentTexture().createView(), loadOp: 'clear', storeOp: 'store' },
      ],
      timestampWrites: timer.writes('composite'),
    });
    drawOverAll(pass, pipelines, stage, this.#group!);
    pass.end();
  }

  destroy(): void {
    if (this.#parameters) this.#context.memory.destroy(this.#parameters);
  }
}
