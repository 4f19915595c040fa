import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import { GpuLimitError, InvalidArgumentError } from '../data/errors.ts';
import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { TilePlan } from '../data/layout/structs.ts';
import type { FrameParts } from '../frame/frame.ts';
import { PAIR_BYTES } from '../frame/parts/pair-capacity.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { dispatchOf, recordDispatches } from '../gpu/passes.ts';
import type { Pipelines, StageDefinition } from '../gpu/pipelines.ts';
import { readBack } from '../gpu/read-back.ts';
import { readFromScratch } from '../gpu/read-from-scratch.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { CONTRIBUTION_UNITS, COST_PLANES, tileCosts } from '../stages/tile-costs/tile-costs.ts';

/** The frame to count: with settings, not a target. */
export interface CostRequest extends FrameRequest {
  /** Settings of the frame. Its splats are listed by tiles even if its rasteriser is `quads`. */
  readonly accuracy: AccuracySettings;
}

/** A number per pixel of a frame's layer: smaller than the image if the resolution is scaled. */
interface PixelMap {
  readonly widthPx: number;
  readonly heightPx: number;
}

/** Costs of a frame: counts per pixel, top row first. */
export interface FrameCosts extends PixelMap {
  /** Entries of the tile's list that are read until the pixel is practically opaque. */
  readonly steps: Uint32Array;
  /** Splats among `steps` whose alpha at the pixel reaches the cutoff: they are blended. */
  readonly blended: Uint32Array;
  /** All splats whose alpha at the pixel reaches the cutoff, hidden ones too: as quads blend them. */
  readonly fragments: Uint32Array;
  /** Length of each tile's list, row by row. */
  readonly tileEntries: Uint32Array;
  /** Tiles in a row. */
  readonly tileColumns: number;
  /** Side of a tile. */
  readonly tilePx: number;
}

/** Contributions of a frame's splats to its image. */
export interface FrameContributions extends PixelMap {
  /** Per pixel: mean log₂ of its splats' `contributionsPx`, weighted by contributions to the pixel. */
  readonly meanLog2: Float32Array;
  /** Per pixel, 0…1. */
  readonly opacity: Float32Array;
  /** Per pixel: splats with centres there that contribute less than `UNSEEN_PX` to the image. */
  readonly unseen: Uint32Array;
  /** Per visible splat: alpha times the transmittance in front of it, summed over all pixels, px. */
  readonly contributionsPx: Float32Array;
}

/** The parts of an engine that counting needs; every `SplatEngine` has them. */
export interface CountedEngine {
  createView(): CountedView;
}

interface CountContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
}

/** The parts of a view that counting needs; every `SplatView` has them. */
export interface CountedView {
  render(request: FrameRequest): boolean;
  whenDrawn(): Promise<void>;
  blended(): { readonly context: CountContext; readonly parts: FrameParts };
  destroy(): void;
}

/**
 * Counts the costs of the frame of `request`: draws it by tiles once more, in a view of its own.
 *
 * @throws GpuLimitError if memory is lacking or the tiles' lists exceed the engine's budget for
 *   them; errors of `SplatView.render` and `whenDrawn`.
 */
export async function countCosts(engine: CountedEngine, request: CostRequest): Promise<FrameCosts> {
  const { pixels, rest, ...size } = await walkTiles(engine, request, 'counts');
  const [steps, blended, fragments] = planesOf(pixels);
  const { TILE_PX } = SHADER_CONSTANTS;
  const tileColumns = Math.ceil(size.widthPx / TILE_PX);
  return { ...size, steps, blended, fragments, tileEntries: rest, tileColumns, tilePx: TILE_PX };
}

/**
 * Adds up the contributions of each splat to the frame of `request`: draws it by tiles once more,
 * in a view of its own.
 *
 * @throws as `countCosts`.
 */
export async function mapContributions(
  engine: CountedEngine,
  request: CostRequest,
): Promise<FrameContributions> {
  const { pixels, rest, widthPx, heightPx } = await walkTiles(engine, request, 'map');
  const [meanLog2, opacity, unseen] = planesOf(pixels);
  const floats = ({ buffer, byteOffset, length }: Uint32Array<ArrayBuffer>) =>
    new Float32Array(buffer, byteOffset, length);
  const contributionsPx = Float32Array.from(
    { length: rest.length / 2 },
    (_, i) => (rest[2 * i] + 2 ** 32 * rest[2 * i + 1]) / CONTRIBUTION_UNITS,
  );
  return { widthPx, heightPx, meanLog2: floats(meanLog2), opacity: floats(opacity), unseen, contributionsPx };
}

type Words = Uint32Array<ArrayBuffer>;

function planesOf(pixels: Words): readonly Words[] {
  const length = pixels.length / COST_PLANES;
  return Array.from({ length: COST_PLANES }, (_, i) => pixels.subarray(i * length, (i + 1) * length));
}

/** Result of one walk over a frame's tiles. */
interface Walk extends PixelMap {
  readonly pixels: Words;
  /** Lengths of the tiles' lists for counts; two words per visible splat for maps. */
  readonly rest: Words;
}

async function walkTiles(engine: CountedEngine, request: CostRequest, pass: 'counts' | 'map'): Promise<Walk> {
  const view = engine.createView();
  const accuracy = { ...request.accuracy, rasterizer: 'tiles' } as const;
  try {
    for (let force = false; ; force = true) {
      view.render({ ...request, accuracy, force });
      await view.whenDrawn();
      const { context, parts } = view.blended();
      if (!parts.shape) throw new InvalidArgumentError('widthPx', 'The frame has no pixels to count.');
      const { accuracy: drawn, isStacked } = parts.shape;
      const counts = tileCosts(drawn.recordPrecision, 'counts', isStacked);
      const stages = pass === 'map' ? [counts, tileCosts(drawn.recordPrecision, 'map', isStacked)] : [counts];
      await context.pipelines.prepare(stages);
      const { neededPairs, hasAllPairs, ...walk } = await readWalk(context, parts, stages);
      if (hasAllPairs) return walk;
      makeRoom(parts, neededPairs);
    }
  } finally {
    view.destroy();
  }
}

/** Gives the next frame room for `neededPairs`. @throws GpuLimitError if they exceed the budget. */
function makeRoom({ tileLists }: FrameParts, neededPairs: number): void {
  const reason = tileLists.whyTooMany(neededPairs);
  if (reason !== null) {
    const message = `Nothing can be counted, because ${reason}. Count at a smaller size, or create the engine with a larger tileBudgetBytes.`;
    throw new GpuLimitError('tileBudgetBytes', neededPairs * PAIR_BYTES, 0, message);
  }
  tileLists.expect(neededPairs, 0, performance.now());
}

/** Runs the stages in order on buffers that they share, and reads the results back. */
async function readWalk(
  { device, pipelines, memory }: CountContext,
  { shape, shared }: FrameParts,
  stages: readonly StageDefinition[],
): Promise<Walk & { readonly neededPairs: number; readonly hasAllPairs: boolean }> {
  const { width: widthPx, height: heightPx } = shared.resources.layer!;
  const { visibleCapacity, dispatchRow } = shape!;
  const { TILE_PX } = SHADER_CONSTANTS;
  const tiles = Math.ceil(widthPx / TILE_PX) * Math.ceil(heightPx / TILE_PX);
  const pixelBytes = 4 * COST_PLANES * widthPx * heightPx;
  const { resources } = shared;
  const walk = (scratch: GpuMemory) => {
    const create = (label: string, bytes: number) =>
      scratch.createBuffer(label, bytes, GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC);
    const pixels = create('costs per pixel', pixelBytes);
    const tileEntries = create('costs per tile', 4 * tiles);
    const contributions = create('contributions', 8 * Math.max(1, visibleCapacity));
    const rest = stages.length > 1 ? contributions : tileEntries;
    const bound = { ...resources, pixels, tileEntries, contributions };
    return readBack(device, TilePlan.bytes + pixelBytes + rest.size, (encoder, target) => {
      const pass = encoder.beginComputePass({ label: 'costs' });
      const size = dispatchSize(tiles, dispatchRow);
      recordDispatches(
        pass,
        stages.map((stage) => dispatchOf(pipelines, stage, bound, size)),
      );
      pass.end();
      encoder.copyBufferToBuffer(resources.tilePlan, 0, target, 0, TilePlan.bytes);
      encoder.copyBufferToBuffer(pixels, 0, target, TilePlan.bytes, pixelBytes);
      encoder.copyBufferToBuffer(rest, 0, target, TilePlan.bytes + pixelBytes, rest.size);
    });
  };
  const bytes = await readFromScratch(memory, 'Counting costs', 'Count at a smaller size.', walk);
  const plan = new Uint32Array(bytes, 0, TilePlan.bytes / 4);
  const planned = (field: keyof typeof TilePlan.offsets) => plan[TilePlan.offsets[field] / 4];
  const restWords = stages.length > 1 ? 2 * planned('visibleCount') : tiles;
  return {
    widthPx,
    heightPx,
    pixels: new Uint32Array(bytes, TilePlan.bytes, pixelBytes / 4),
    rest: new Uint32Array(bytes, TilePlan.bytes + pixelBytes, restWords),
    neededPairs: planned('neededPairs'),
    hasAllPairs: planned('fits') === 1 && planned('binShift') === 0,
  };
}
