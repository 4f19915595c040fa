import type { LeafLevel, LeafScene, SceneLeaf, SplatCells } from '../../data/bricks/leaf-scene.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import type { StreamReport } from '../cloud-stream.ts';
import { ViewedStream } from '../viewed-stream.ts';
import { type PlannedLeaf, planLeaves } from './leaf-plan.ts';
import type { LeafPool, PlacedSplats } from './leaf-pool.ts';

/** Files that are fetched at once. */
export const FETCHED_AT_ONCE = 4;

/** A level of a leaf that has been decoded, and is about to be placed. */
interface ReadyLevel {
  readonly level: number;
  readonly pieces: readonly SplatCells[];
}

/** What is on the GPU of a leaf: its coarsest level, and perhaps a finer one, which is drawn instead. */
interface PlacedLeaf {
  readonly leaf: SceneLeaf;
  readonly coarsest: PlacedSplats;
  finer: { readonly level: number; readonly splats: PlacedSplats } | null;
  ready: ReadyLevel | null;
}

/**
 * Keeps that level of each leaf of a scene on the GPU that its views need most, beside the coarsest
 * one. One level of a leaf is drawn, and another takes its place between two frames.
 */
export class LeafStream extends ViewedStream {
  readonly #scene: LeafScene;
  readonly #pool: LeafPool;
  readonly #placed: readonly PlacedLeaf[];
  /** Chunks for levels but the coarsest ones. */
  readonly #roomChunks: number;
  #plan: readonly PlannedLeaf[] = [];
  /** Files that are fetched, decoded and taken, by number. */
  readonly #fetches = new Map<number, AbortController>();
  #isAboutToChange = false;

  /** @param coarsest the coarsest level of each leaf, in `pool`, which has nothing else. */
  constructor(scene: LeafScene, pool: LeafPool, coarsest: readonly PlacedSplats[]) {
    super();
    this.#scene = scene;
    this.#pool = pool;
    this.#placed = scene.leaves.map((leaf, i) => ({ leaf, coarsest: coarsest[i], finer: null, ready: null }));
    this.#roomChunks = pool.freeChunks;
  }

  report(): StreamReport {
    const sum = (chunksOf: (placed: PlacedLeaf, i: number) => number) =>
      this.#placed.reduce((total, placed, i) => total + chunksOf(placed, i), 0);
    const missing = (placed: PlacedLeaf, i: number) => {
      const plan = this.#plan[i];
      return plan && isMissing(placed, plan, plan.wanted) ? chunksIn(placed.leaf.levels[plan.wanted]) : 0;
    };
    return {
      bricks: sum(({ leaf }) => leaf.levels.reduce((count, level) => count + chunksIn(level), 0)),
      residentBricks: this.#pool.chunkCells - this.#pool.freeChunks,
      mostBricks: this.#pool.chunkCells,
      missingBricks: sum(missing),
      refusedBricks: sum((placed, i) =>
        this.#plan[i]?.target === this.#plan[i]?.wanted ? 0 : missing(placed, i),
      ),
      fetching: this.#fetches.size,
      fetchedBytes: this.#scene.fetchedBytes,
      bytesPerSecond: this.#fetches.size > 0 ? this.rate.bytesPerSecond : 0,
      isComplete: this.isSeen && this.#placed.every((placed, i) => !this.#isToChange(placed, i)),
      error: this.error,
    };
  }

  override end(): void {
    for (const ending of this.#fetches.values()) ending.abort();
    super.end();
  }

  /** Plans anew, fetches what is missing, ends other fetches, and sees to it that what is there changes. */
  protected follow(): void {
    if (this.isEnded) return;
    this.#plan = planLeaves(this.#scene.leaves, this.sights, this.#roomChunks);
    const wanted = new Set(this.#missing().map((i) => this.#targetOf(i).file));
    for (const [file, ending] of this.#fetches) if (!wanted.has(file)) ending.abort();
    for (const file of wanted) {
      if (this.error || this.#fetches.size >= FETCHED_AT_ONCE) break;
      if (!this.#fetches.has(file)) void this.#bring(file);
    }
    const isWaiting = this.#placed.some(({ ready }, i) => ready || this.#isTooFine(i));
    if (isWaiting && !this.#isAboutToChange) {
      this.#isAboutToChange = true;
      // A view that says what it sees is about to draw what is there.
      queueMicrotask(() => this.#change());
    }
    this.settle(!isWaiting && this.#fetches.size === 0);
  }

  /** Leaves whose planned level is neither there nor ready, the most valuable first. */
  #missing(): number[] {
    return [...this.#placed.keys()]
      .filter((i) => {
        const [placed, plan] = [this.#placed[i], this.#plan[i]];
        return isMissing(placed, plan, plan.target) && placed.ready?.level !== plan.target;
      })
      .sort((a, b) => this.#plan[b].value - this.#plan[a].value || a - b);
  }

  #targetOf(i: number): LeafLevel {
    return this.#placed[i].leaf.levels[this.#plan[i].target];
  }

  /** Whether a leaf in sight is to be drawn at its coarsest level, and is not. */
  #isTooFine(i: number): boolean {
    const { isSeen, target } = this.#plan[i];
    return isSeen && this.#placed[i].finer !== null && target === coarsestOf(this.#placed[i]);
  }

  /** Whether another level of a leaf is to be drawn than the one that is. */
  #isToChange(placed: PlacedLeaf, i: number): boolean {
    return isMissing(placed, this.#plan[i], this.#plan[i].target) || this.#isTooFine(i);
  }

  /** Fetches a file and makes ready what is missing of it. */
  async #bring(file: number): Promise<void> {
    const ending = new AbortController();
    const { signal } = ending;
    if (this.#fetches.size === 0) this.rate.begin();
    this.#fetches.set(file, ending);
    try {
      const decoded = await this.#scene.read(file, signal, (bytes) => this.rate.take(bytes));
      const next = () => this.#missing().find((i) => this.#targetOf(i).file === file);
      for (let i = next(); i !== undefined; i = next()) {
        const { target } = this.#plan[i];
        const { leaf } = this.#placed[i];
        const pieces = await decoded.pieces(leaf, leaf.levels[target], signal);
        this.#placed[i].ready = { level: target, pieces };
        this.follow();
      }
    } catch (error) {
      if (!signal.aborted) this.error = error as Error;
    }
    this.#fetches.delete(file);
    this.follow();
  }

  /** Draws what is ready, and what is planned and there, unless what is there must not change. */
  #change(): void {
    this.#isAboutToChange = false;
    if (this.isEnded || this.isHeld) return;
    let hasChanged = false;
    for (const [i, placed] of this.#placed.entries()) {
      const { ready } = placed;
      placed.ready = null;
      if (ready && ready.level === this.#plan[i].target) this.#place(i, ready);
      else if (this.#isTooFine(i)) this.#coarsen(placed);
      else continue;
      hasChanged = true;
    }
    if (hasChanged) this.redraw();
    this.follow();
  }

  #place(i: number, { level, pieces }: ReadyLevel): void {
    const placed = this.#placed[i];
    const chunkCount = pieces.reduce((sum, { cells }) => sum + cells.length, 0);
    const own = placed.finer?.splats.chunkCount ?? 0;
    // All that is planned has room: so what is not goes, that out of sight first.
    const others = [...this.#placed.keys()].filter((other) => {
      const { finer } = this.#placed[other];
      return other !== i && finer && finer.level !== this.#plan[other].target;
    });
    others.sort((a, b) => Number(this.#plan[a].isSeen) - Number(this.#plan[b].isSeen) || a - b);
    for (const other of others) {
      if (this.#pool.freeChunks + own >= chunkCount) break;
      this.#coarsen(this.#placed[other]);
    }
    if (placed.finer) this.#pool.remove(placed.finer.splats);
    else this.#pool.show(placed.coarsest, false);
    placed.finer = { level, splats: this.#pool.place(pieces) };
  }

  /** Draws the coarsest level of a leaf instead of a finer one. */
  #coarsen(placed: PlacedLeaf): void {
    this.#pool.remove(placed.finer!.splats);
    placed.finer = null;
    this.#pool.show(placed.coarsest, true);
  }
}

function chunksIn({ count }: LeafLevel): number {
  return chunkCountOf(count);
}

function coarsestOf({ leaf }: PlacedLeaf): number {
  return leaf.levels.length - 1;
}

/** Whether a level is to be fetched: finer than what is there, or coarser than what is seen. */
function isMissing(placed: PlacedLeaf, { isSeen }: PlannedLeaf, level: number): boolean {
  const shown = placed.finer?.level ?? coarsestOf(placed);
  return level < shown || (isSeen && level > shown && level < coarsestOf(placed));
}
