import { binGrid } from '../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { TileGrid, TilePlan } from '../data/layout/structs.ts';
import type { FrameParts } from '../frame/frame.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import { dispatchOf, type FramePass, recordDispatches } from '../gpu/passes.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { SubmissionPacer } from '../gpu/timing/submission-pacer.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { tileCount } from '../stages/tiles/tiles.ts';
import { type CommandPart, commandsOf, type FrameCommand, recordCommand } from './frame-commands.ts';
import type { ViewContext } from './view-frames.ts';

const { BIN_TILES, TILE_COUNT_BLOCK } = SHADER_CONSTANTS;
const TILES_PER_BIN = BIN_TILES * BIN_TILES;

/** Side of the cells by which the area of quads is estimated, px. */
const CELL_PX = 8;
/**
 * Time on the slowest devices to blend a splat over a cell, or to draw a quad without pixels, ms.
 */
const SLOWEST_CELL_MS = 1.3e-3;

/**
 * Least share of the waiting time that counts as work. Firefox polls for completion, so short work
 * seems to take no time.
 */
const LEAST_WORK = 1 / 8;

/** Advice in the error if the device lacks memory for dividing a frame. */
const ADVICE = 'Draw a smaller image, or load fewer splats.';

type Context = Pick<ViewContext, 'device' | 'pipelines' | 'memory' | 'dispatchRow' | 'submissionBudgetMs'>;

/** A frame to submit in parts. */
export interface DividedFrame {
  readonly parts: FrameParts;
  readonly plan: FramePlan;
  /** Passes that find and sort the visible splats. */
  readonly orderPasses: readonly FramePass[];
  /** Records the short remainder, after the splats have been drawn into their layer. */
  readonly recordEnd: (encoder: GPUCommandEncoder) => void;
  /** Whether the buffers that `orderPasses` use still exist. */
  readonly canOrder: () => boolean;
  /** Whether the buffers that drawing and `recordEnd` read still exist. */
  readonly canDraw: () => boolean;
}

/**
 * Submits frames of one view in parts. The GPU ends each part before the next is submitted, so that
 * none exceeds the budget and the page can run in between. Images are bit-identical to a single
 * submission: quads and tiles are drawn in successive ranges of their order. Not divided: a
 * dispatch that finds or sorts splats, the ends of long lists, a single quad, a single tile.
 */
export class FrameDivider {
  readonly #context: Context;
  readonly #pacer: SubmissionPacer;
  /** Shortest time until a submission was reported complete, ms. Firefox polls every 100 ms. */
  #waitMs = Number.POSITIVE_INFINITY;

  constructor(context: Context) {
    this.#context = context;
    this.#pacer = new SubmissionPacer(context.submissionBudgetMs);
  }

  /**
   * Returns the time of all parts, without the pauses between them, ms; null if a resource of the
   * frame has been destroyed.
   *
   * @throws GpuLimitError if the device lacks memory for the counts that divide the frame.
   */
  async submit(frame: DividedFrame): Promise<number | null> {
    try {
      return await this.#submitParts(frame);
    } catch (error) {
      // Awaited resources may be destroyed with the view.
      if (!frame.canDraw()) return null;
      throw error;
    }
  }

  async #submitParts(frame: DividedFrame): Promise<number | null> {
    const { device } = this.#context;
    // Earlier work must not count towards the first part.
    await this.#allDone();
    if (this.#waitMs === Number.POSITIVE_INFINITY) await this.#submit([], frame);
    const orderMs = await this.#submitOrder(commandsOf(frame.orderPasses), frame);
    if (orderMs === null) return null;
    let elapsedMs = orderMs;
    for (const command of commandsOf(frame.parts.drawPasses({ kind: 'image' }))) {
      const tookMs = await this.#submitDivided(command, frame);
      if (tookMs === null) return null;
      elapsedMs += tookMs;
    }
    if (!frame.canDraw()) return null;
    const encoder = device.createCommandEncoder({ label: 'websplatter end of a frame' });
    frame.recordEnd(encoder);
    device.queue.submit([encoder.finish()]);
    return elapsedMs;
  }

  async #submitOrder(commands: readonly FrameCommand[], frame: DividedFrame): Promise<number | null> {
    let elapsedMs = 0;
    for (let first = 0; first < commands.length; ) {
      if (!frame.canOrder()) return null;
      const together = commands.slice(first, first + this.#pacer.fittingFrom(first, commands));
      const tookMs = await this.#submit(together, frame);
      this.#pacer.take(together, tookMs);
      elapsedMs += tookMs;
      first += together.length;
    }
    return elapsedMs;
  }

  async #submitDivided(command: FrameCommand, frame: DividedFrame): Promise<number | null> {
    const { stage } = command;
    if (!frame.canDraw()) return null;
    const slowestMs = await this.#slowestMsOfUnits(stage, frame);
    if (!slowestMs) return null;
    const units = slowestMs.length - 1;
    let elapsedMs = 0;
    let first = 0;
    do {
      if (!frame.canDraw()) return null;
      const count = Math.min(this.#pacer.unitsFrom(first, stage, slowestMs), units - first);
      if (stage === 'tile-rasterize') this.#writeFirstTile(first, frame);
      const part = { first, count, isLast: first + count >= units };
      const tookMs = await this.#submit([command], frame, isDivisible(stage) ? part : undefined);
      const work = { stage, slowestMs: slowestMs[first + count] - slowestMs[first] };
      if (count > 0) this.#pacer.take([work], tookMs);
      elapsedMs += tookMs;
      first += count;
    } while (first < units);
    return elapsedMs;
  }

  /** Returns the time of the work, ms, without the time to report completion. */
  async #submit(
    commands: readonly FrameCommand[],
    { parts, plan }: DividedFrame,
    part?: CommandPart,
  ): Promise<number> {
    const { device } = this.#context;
    const { dispatchRow } = plan.shape;
    const encoder = device.createCommandEncoder({ label: 'websplatter part of a frame' });
    for (const command of commands) recordCommand(encoder, parts.timer, command, part, dispatchRow);
    const submittedMs = performance.now();
    device.queue.submit([encoder.finish()]);
    await this.#allDone();
    const tookMs = performance.now() - submittedMs;
    this.#waitMs = Math.min(this.#waitMs, tookMs);
    return Math.max(tookMs - this.#waitMs, LEAST_WORK * tookMs);
  }

  /** Resolves also when the device is lost. */
  async #allDone(): Promise<void> {
    // The loss of a device ends its views, which report it.
    await this.#context.device.queue.onSubmittedWorkDone().catch(() => {});
  }

  /**
   * Cumulative time on the slowest device: entry `i` is for the units before unit `i`, the last
   * entry for all. Stages that cannot be divided are one unit. Null if a resource of the frame has
   * been destroyed.
   */
  async #slowestMsOfUnits(stage: string, frame: DividedFrame): Promise<Float64Array | null> {
    if (stage === 'tile-rasterize') return this.#slowestMsOfTiles(frame);
    if (stage === 'rasterize') return this.#slowestMsOfQuads(frame);
    const { widthPx, heightPx } = frame.plan.request;
    return Float64Array.of(0, (SLOWEST_CELL_MS * widthPx * heightPx) / CELL_PX ** 2);
  }

  #writeFirstTile(tile: number, { parts }: DividedFrame): void {
    const { grid } = parts.shared.resources;
    this.#context.device.queue.writeBuffer(grid, TileGrid.offsets.firstTile, Uint32Array.of(tile));
  }

  /** Tiles in dispatch order, as if each blended every pair of its bin. */
  async #slowestMsOfTiles({ parts, plan }: DividedFrame): Promise<Float64Array> {
    const { device } = this.#context;
    const { tilePlan, binStarts, binOrder } = parts.shared.resources;
    const words = await Promise.all([tilePlan, binStarts, binOrder].map((each) => readWords(device, each)));
    const [counts, starts, order] = words;
    const shift = counts[TilePlan.offsets.binShift / 4];
    const { binColumns } = binGrid(plan.layer.widthPx, plan.layer.heightPx);
    const columns = Math.ceil(binColumns / 2 ** shift);
    const before = new Float64Array(plan.shape.binCount * TILES_PER_BIN + 1);
    for (let tile = 0; tile + 1 < before.length; tile++) {
      const bin = order[Math.floor(tile / TILES_PER_BIN)];
      const listed = (Math.floor(bin / binColumns) >> shift) * columns + ((bin % binColumns) >> shift);
      const pairs = starts[listed + 1] - starts[listed];
      before[tile + 1] = before[tile] + SLOWEST_CELL_MS * (1 + pairs);
    }
    return before;
  }

  /** Quads in drawing order, far first, by the number of cells that each may touch. */
  async #slowestMsOfQuads({ parts, plan, canDraw }: DividedFrame): Promise<Float64Array | null> {
    const { device, pipelines, dispatchRow } = this.#context;
    const { shape, layer } = plan;
    const { resources } = parts.shared;
    const [, count] = await readWords(device, resources.drawArguments);
    const before = new Float64Array(count + 1);
    if (count === 0) return before;
    // The stage that counts the bins per splat counts cells, if a bin is as small as a cell.
    const { isNarrow } = shape.sortDevice;
    const counting = tileCount({ ...shape.accuracy, isStacked: shape.isStacked, isNarrow });
    const stage = { ...counting, constants: { ...counting.constants, BIN_PX: CELL_PX } };
    await pipelines.prepare([stage]);
    if (!canDraw()) return null;
    const blocks = Math.ceil(count / TILE_COUNT_BLOCK);
    // Keys are not needed after sorting, so their buffer is reused.
    const pairOffsets = resources.keys;
    const memory = this.#context.memory.part();
    const countCells = () => {
      const { UNIFORM, STORAGE, COPY_SRC, COPY_DST } = GPUBufferUsage;
      const grid = memory.createBuffer('cell grid', TileGrid.bytes, UNIFORM | COPY_DST);
      const contents = TileGrid.pack({
        sizePx: [layer.widthPx, layer.heightPx],
        binColumns: Math.ceil(layer.widthPx / CELL_PX),
        binRows: Math.ceil(layer.heightPx / CELL_PX),
        pairCapacity: 0,
        firstTile: 0,
      });
      device.queue.writeBuffer(grid, 0, contents);
      const blockPairs = memory.createBuffer('cells of blocks', 4 * blocks, STORAGE | COPY_SRC);
      const encoder = device.createCommandEncoder({ label: 'websplatter cells of quads' });
      const pass = encoder.beginComputePass({ label: 'cells of quads' });
      const bound = { ...resources, grid, pairOffsets, blockPairs };
      recordDispatches(pass, [dispatchOf(pipelines, stage, bound, dispatchSize(blocks, dispatchRow))]);
      pass.end();
      device.queue.submit([encoder.finish()]);
      return blockPairs;
    };
    try {
      const { result: blockPairs, checked } = memory.guard('A frame in parts', ADVICE, countCells);
      await checked;
      if (!canDraw()) return null;
      const [offsets, sums] = await Promise.all([
        readWords(device, pairOffsets, count),
        readWords(device, blockPairs),
      ]);
      for (let i = 0; i < count; i++) {
        // Rank 0 is the nearest splat.
        const rank = count - 1 - i;
        const isLastOfBlock = rank + 1 === count || (rank + 1) % TILE_COUNT_BLOCK === 0;
        const end = isLastOfBlock ? sums[Math.floor(rank / TILE_COUNT_BLOCK)] : offsets[rank + 1];
        before[i + 1] = before[i] + SLOWEST_CELL_MS * (1 + end - offsets[rank]);
      }
      return before;
    } finally {
      memory.destroyAll();
    }
  }
}

/** Whether commands of this stage can be encoded in ranges. */
function isDivisible(stage: string): boolean {
  return stage === 'tile-rasterize' || stage === 'rasterize';
}
