import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import type { ComputePass } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { dispatchSize } from '../../stages/dispatch.ts';
import { tileRasterize } from '../../stages/tiles/tiles.ts';
import type { FramePart, PartContext } from '../frame-part.ts';
import { type FrameShape, perShape } from '../frame-shape.ts';
import { HostGroup } from '../host-textures.ts';

/** The stage that blends the tiles; null for shapes without tiles. */
const stageOf = perShape((shape) => {
  const { rasterizer, accuracy, depth, sortDevice, isStacked } = shape;
  if (rasterizer !== 'tiles') return null;
  const { recordPrecision, colorTarget } = accuracy;
  return tileRasterize({
    recordPrecision,
    colorTarget,
    depth,
    // By wide keys, records' float32 depths may go back, but by no more than their rounding.
    isExactOrder: !shape.shortensKeys && !shape.sortsByDistance,
    isNarrow: sortDevice.isNarrow,
    isStacked,
  });
});

/** Blends the visible splats front to back, a workgroup per tile. */
export class Tiles implements FramePart {
  readonly #context: PartContext;
  /** By the tested depth: hosts may replace their depth texture between two frames. */
  readonly #group = new HostGroup();

  constructor(context: PartContext) {
    this.#context = context;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return [stageOf(shape) ?? []].flat();
  }

  bind(): void {
    this.#group.clear();
  }

  /** Null for shapes without tiles. */
  pass(shape: FrameShape): ComputePass | null {
    const stage = stageOf(shape);
    if (!stage) return null;
    const tiles = shape.binCount * SHADER_CONSTANTS.BIN_TILES ** 2;
    const dispatch = {
      pipeline: this.#context.pipelines.compute(stage)!,
      group: this.#bound(shape),
      size: dispatchSize(Math.max(1, tiles), shape.dispatchRow),
    };
    return { label: 'tiles', timed: 'tiles', dispatches: [dispatch] };
  }

  #bound(shape: FrameShape): GPUBindGroup {
    const { pipelines, shared } = this.#context;
    const testedDepth = shape.depth && shared.testedDepth;
    const { color, depthLayer } = shared.blended!;
    return this.#group.for([testedDepth], () =>
      pipelines.bindGroup(stageOf(shape)!, {
        ...shared.buffers,
        grid: shared.buffers.tileGrid,
        layer: color.createView(),
        ...(shape.depth && { hostDepth: shared.hostDepth! }),
        ...(testedDepth && { testedDepth: testedDepth.createView() }),
        ...(depthLayer && { depthLayer: depthLayer.createView() }),
      }),
    );
  }
}
