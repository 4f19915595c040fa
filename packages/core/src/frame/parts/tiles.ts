import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { ComputePass, Dispatch, DispatchSize } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { dispatchSize } from '../../stages/dispatch.ts';
import { splitsLists, tileRasterize, tileRest } from '../../stages/tiles/tiles.ts';
import { createBuffers, type FramePart, type PartChange, type PartContext } from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, perShape } from '../frame-shape.ts';
import { HostGroup } from '../host-textures.ts';

const { BIN_TILES, TILE_PX } = SHADER_CONSTANTS;
/** Most tiles with long lists whose front is kept, a kilobyte each; others are blended from the front again. */
const MOST_FRONTS = 4096;
const FRONT_BYTES = 16 * TILE_PX ** 2;
/** Workgroups of tile-rest: each blends one tile after the other. */
const REST_WORKGROUPS = 1024;

const variantOf = (shape: FrameShape) => ({
  recordPrecision: shape.accuracy.recordPrecision,
  colorTarget: shape.accuracy.colorTarget,
  depth: shape.depth,
  // By wide keys, records' float32 depths may go back, but by no more than their rounding.
  isExactOrder: !shape.shortensKeys && !shape.sortsByDistance,
  isNarrow: shape.sortDevice.isNarrow,
  isStacked: shape.isStacked,
});

/** Both are null without tiles; `rest` is, too, where lists are not split. */
const stagesOf = perShape((shape) => {
  const variant = shape.rasterizer === 'tiles' ? variantOf(shape) : null;
  return {
    rasterize: variant && tileRasterize(variant),
    rest: variant && splitsLists(variant) ? tileRest(variant) : null,
  };
});

const tileCountOf = ({ binCount }: FrameShape) => Math.max(1, binCount * BIN_TILES ** 2);

/** The own buffers: see tile-rasterize. */
interface LongTiles {
  readonly longTiles: GPUBuffer;
  readonly frontPixels: GPUBuffer;
}

/** Blends the visible splats front to back: a workgroup per tile, then the ends of long lists. */
export class Tiles implements FramePart {
  readonly #context: PartContext;
  readonly #memory: GpuMemory;
  /** Null for shapes that split no lists. */
  #long: LongTiles | null = null;
  /** By the tested depth: hosts may replace their depth texture between two frames. */
  readonly #groups = { rasterize: new HostGroup(), rest: new HostGroup() };

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return Object.values(stagesOf(shape)).filter((stage) => stage !== null);
  }

  fit({ shape }: FramePlan): PartChange | null {
    const tileCount = stagesOf(shape).rest ? tileCountOf(shape) : 0;
    const listBytes = tileCount > 0 ? 8 + 8 * tileCount : 0;
    if (listBytes === (this.#long?.longTiles.size ?? 0)) return null;
    return {
      free: () => this.#memory.destroyAll(),
      make: () => {
        const table = {
          longTiles: [listBytes, GPUBufferUsage.STORAGE],
          frontPixels: [FRONT_BYTES * Math.min(MOST_FRONTS, tileCount), GPUBufferUsage.STORAGE],
        } as const;
        this.#long = tileCount > 0 ? createBuffers(this.#memory, 'tiles', table) : null;
      },
    };
  }

  bind(): void {
    for (const group of Object.values(this.#groups)) group.clear();
  }

  /** Null for shapes without tiles. */
  pass(shape: FrameShape): ComputePass | null {
    const { rasterize, rest } = stagesOf(shape);
    if (!rasterize) return null;
    const tileCount = tileCountOf(shape);
    const dispatches = [this.#dispatch(shape, 'rasterize', dispatchSize(tileCount, shape.dispatchRow))];
    if (rest) dispatches.push(this.#dispatch(shape, 'rest', [Math.min(REST_WORKGROUPS, tileCount), 1, 1]));
    return { label: 'tiles', timed: 'tiles', dispatches };
  }

  #dispatch(shape: FrameShape, name: 'rasterize' | 'rest', size: DispatchSize): Dispatch {
    const { pipelines, shared } = this.#context;
    const stage = stagesOf(shape)[name]!;
    const { testedDepth } = shared;
    const { color, depthLayer } = shared.blended!;
    const group = this.#groups[name].for([testedDepth], () =>
      pipelines.bindGroup(stage, {
        ...shared.buffers,
        ...this.#long,
        grid: shared.buffers.tileGrid,
        layer: color.createView(),
        ...(shape.depth && { hostDepth: shared.hostDepth! }),
        ...(testedDepth && { testedDepth: testedDepth.createView() }),
        ...(depthLayer && { depthLayer: depthLayer.createView() }),
      }),
    );
    return { pipeline: pipelines.compute(stage)!, group, size };
  }
}
