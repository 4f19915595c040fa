import type { BrickCell } from '../../data/bricks/brick.ts';
import type { SplatCells } from '../../data/bricks/leaf-scene.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { type DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import { type ChunkMove, chunkBytes, mergeStages, shBytes } from '../stream/chunk-pages.ts';
import {
  type Chunks,
  joined,
  makePool,
  type PoolShape,
  ScenePool,
  type StreamedScene,
  WRITTEN_AT_ONCE,
} from '../stream/scene-pool.ts';

/** Cells in successive slots. */
interface Run {
  readonly cells: readonly BrickCell[];
  readonly first: number;
}

const noParent = () => LEVEL_CONSTANTS.NO_CELL;

/** Chunks from which on a run is written by itself; to join smaller ones takes less time than their writes. */
const LARGE_RUN = 8;

/** See `PoolShape`. */
type LeafPoolShape = Pick<PoolShape, 'chunkCells' | 'firstChunks'>;

/** A run at its place in a smaller pool, and the copy that moves it there. */
type MovedRun = Run & ChunkMove;

/** Chunks of a piece that take successive slots. */
interface PlacedRun extends Chunks {
  readonly piece: SplatCells;
  /** The first of its cells. */
  readonly from: number;
}

/** Splats of one piece on the GPU. */
export interface PlacedSplats {
  /** Changes when the pool shrinks. */
  runs: readonly Run[];
  readonly chunkCount: number;
  readonly level: number;
  isShown: boolean;
}

/**
 * GPU memory for levels of the leaves of one scene, drawn by its cloud. Each chunk of splats is
 * merged to roots of its own, so the levels form a forest. Chunks take any free slots. The caller alone
 * decides which levels are resident.
 */
export class LeafPool extends ScenePool {
  /** Per chunk. */
  readonly #isTaken: Uint8Array;
  /** Level of the leaf, per chunk. */
  readonly #levels: Uint8Array;
  #takenChunks = 0;
  readonly #placed = new Set<PlacedSplats>();
  /** Chunks of placed splats that have not been written. */
  #unwritten: PlacedRun[] = [];
  #unwrittenChunks = 0;
  /** Placed splats without blobs. */
  readonly #unmerged = new Set<PlacedSplats>();

  /** @param before a pool whose splats move into this one; they must fit. */
  private constructor(
    context: DispatchContext,
    scene: StreamedScene,
    shape: LeafPoolShape,
    before?: LeafPool,
  ) {
    const moved: ReadonlyMap<PlacedSplats, readonly MovedRun[]> = before ? before.#moves : new Map();
    const moves = [...moved.values()].flat();
    super(context, scene, { ...shape, upperCells: 0 }, before && { pool: before, moves, upperMoves: [] });
    this.#isTaken = new Uint8Array(shape.chunkCells);
    this.#levels = new Uint8Array(shape.chunkCells);
    if (before) this.#takeOver(before, moved);
  }

  /**
   * Makes an empty pool.
   *
   * @throws GpuLimitError if the device has no room for it; nothing is left allocated then.
   */
  static make(context: DispatchContext, scene: StreamedScene, shape: LeafPoolShape): Promise<LeafPool> {
    const stages = mergeStages(scene.shDegree).chunks;
    return makePool(context, scene, stages, (own) => new LeafPool(own, scene, shape));
  }

  /** Chunks for which there is memory. */
  get chunkCount(): number {
    return this.pages.chunkCount;
  }

  /** Adds memory for this many chunks in all, if there are fewer and the engine's budget has room. */
  growTo(chunkCount: number): void {
    if (chunkCount > this.chunkCount) this.grow(chunkCount - this.chunkCount);
  }

  /** The smaller pool that replaces this one, in its cloud; all of its splats must fit. */
  shrunkTo(chunkCount: number): LeafPool {
    this.merge();
    const { context, scene, chunkCells } = this;
    const growthBytes = (chunkCount - this.chunkCount) * chunkBytes(scene.shDegree);
    const shape = { chunkCells, firstChunks: chunkCount };
    return this.replaced(growthBytes, () => new LeafPool(context, scene, shape, this)) ?? this;
  }

  get freeChunks(): number {
    return this.chunkCount - this.#takenChunks;
  }

  /**
   * Places splats in free chunks, of which there must be enough. `merge` writes them and makes their
   * blobs, `show` draws them.
   *
   * @param level level of the leaf; 0 is the finest.
   */
  place(piece: SplatCells, level: number): PlacedSplats {
    const placed = { runs: this.#take(piece), chunkCount: piece.cells.length, level, isShown: false };
    for (const { cells, first } of placed.runs) this.#levels.fill(level, first, first + cells.length);
    this.#placed.add(placed);
    this.#unmerged.add(placed);
    if (this.#unwrittenChunks >= WRITTEN_AT_ONCE) this.#write();
    return placed;
  }

  /**
   * Merges the blobs of all splats placed since the last call. Call it after changes and before the
   * next frame.
   */
  merge(): void {
    if (this.#unmerged.size === 0) return;
    this.#write();
    const dispatches = new Dispatches(this.context);
    const placed = [...this.#unmerged];
    const chunksOf = ({ first, cells }: Run) => ({
      ...{ first, count: cells.length },
      pageEnd: this.pages.pageEnd(first),
    });
    for (const { first, count } of joined(placed.flatMap(({ runs }) => runs.map(chunksOf))))
      this.mergeChunks(dispatches, first, count);
    dispatches.submit(`${this.scene.name} leaves`);
    this.#unmerged.clear();
    // Merging needs the bounds of their cells.
    for (const { runs, isShown } of placed) if (!isShown) this.#hide(runs);
    this.onChanged();
  }

  /** Draws placed splats, or hides them without removing them. */
  show(placed: PlacedSplats, isShown: boolean): void {
    placed.isShown = isShown;
    if (this.#unmerged.has(placed)) return;
    if (!isShown) this.#hide(placed.runs);
    else
      for (const { cells, first } of placed.runs) {
        this.writeCells(cells, first, noParent);
        this.pages.bound(cells, first);
      }
    this.onChanged();
  }

  /** Moves the cells of chunks out of every frustum. */
  #hide(runs: readonly Run[]): void {
    for (const { cells, first } of runs) {
      this.hideCells(first, cells.length);
      this.pages.unbound(first, cells.length);
    }
  }

  remove(placed: PlacedSplats): void {
    const { runs, chunkCount } = placed;
    if (this.#unmerged.has(placed)) this.#write();
    this.#placed.delete(placed);
    this.#unmerged.delete(placed);
    for (const { cells, first } of runs) {
      this.pages.clear(first, cells.length);
      this.#isTaken.fill(0, first, first + cells.length);
    }
    this.#takenChunks -= chunkCount;
    this.onChanged();
  }

  levelOf(cell: number): number {
    return this.#levels[cell] ?? 0;
  }

  childCell(): null {
    return null;
  }

  /** Takes the first free chunks for a piece. */
  #take(piece: SplatCells): Run[] {
    const { cells } = piece;
    const runs: Run[] = [];
    for (let from = 0; from < cells.length; ) {
      const first = this.#isTaken.indexOf(0);
      const pageEnd = this.pages.pageEnd(first);
      let to = from;
      let chunk = first;
      do {
        this.#isTaken[chunk++] = 1;
        to++;
      } while (to < cells.length && chunk < pageEnd && this.#isTaken[chunk] === 0);
      runs.push({ cells: cells.slice(from, to), first });
      const run = { first, count: to - from, pageEnd, piece, from };
      if (run.count >= LARGE_RUN) this.#writeRun(first, run.count, [run]);
      else {
        this.#unwritten.push(run);
        this.#unwrittenChunks += run.count;
      }
      from = to;
    }
    this.#takenChunks += cells.length;
    return runs;
  }

  /** Writes the placed splats to the GPU: one write per run of chunks, since leaves may be small. */
  #write(): void {
    for (const { first, count, parts } of joined(this.#unwritten)) this.#writeRun(first, count, parts);
    this.#unwritten = [];
    this.#unwrittenChunks = 0;
  }

  /** @param parts together the chunks from `first` on. */
  #writeRun(first: number, count: number, parts: readonly PlacedRun[]): void {
    const words = (of: (piece: SplatCells) => Uint32Array<ArrayBuffer>, perSplat: number) => {
      const stride = CHUNK_SPLATS * perSplat;
      const wordsOf = ({ piece, from, count: length }: PlacedRun) =>
        of(piece).subarray(stride * from, stride * (from + length));
      if (parts.length === 1) return wordsOf(parts[0]);
      const all = new Uint32Array(stride * count);
      for (const part of parts) all.set(wordsOf(part), stride * (part.first - first));
      return all;
    };
    const cells = parts.flatMap(({ piece, from, count: length }) => piece.cells.slice(from, from + length));
    this.writeCells(cells, first, noParent);
    this.pages.writeSplats(
      {
        geometry: words(({ geometry }) => geometry, GEOMETRY_WORDS.packed),
        harmonics: words(({ harmonics }) => harmonics, shBytes(this.scene.shDegree) / 4),
        fileIndices: words(({ fileIndices }) => fileIndices, 1),
      },
      first,
    );
    this.pages.writeCells(cells, first);
  }

  /** The runs of all splats in a smaller pool: compact and in order, each page filled from its start. */
  get #moves(): Map<PlacedSplats, readonly MovedRun[]> {
    const { mostPageChunks } = this.pages;
    const moves = new Map<PlacedSplats, MovedRun[]>();
    let to = 0;
    for (const placed of this.#placed) {
      const runs: MovedRun[] = [];
      for (const { cells, first } of placed.runs)
        for (let done = 0; done < cells.length; ) {
          const count = Math.min(cells.length - done, mostPageChunks - (to % mostPageChunks));
          runs.push({ cells: cells.slice(done, done + count), first: to, from: first + done, to, count });
          done += count;
          to += count;
        }
      moves.set(placed, runs);
    }
    return moves;
  }

  /** Takes over the splats of a larger pool, which have been copied. */
  #takeOver(before: LeafPool, moves: ReadonlyMap<PlacedSplats, readonly MovedRun[]>): void {
    for (const [placed, runs] of moves) {
      for (const { cells, from, to, count } of runs) {
        const [start, end] = [CHUNK_SPLATS * from, CHUNK_SPLATS * (from + count)];
        this.writeCells(cells, to, noParent);
        this.pages.keepFileIndices(before.pages.fileIndices.subarray(start, end), to);
        this.pages.writeCells(cells, to);
        this.#isTaken.fill(1, to, to + count);
      }
      placed.runs = runs;
      for (const { first, count } of runs) this.#levels.fill(placed.level, first, first + count);
      this.#placed.add(placed);
      this.#unmerged.add(placed);
      this.#takenChunks += placed.chunkCount;
    }
    this.merge();
  }
}
