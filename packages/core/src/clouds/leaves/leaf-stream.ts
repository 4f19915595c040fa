import type { LeafFile, LeafLevel, LeafScene, SplatCells } from '../../data/bricks/leaf-scene.ts';
import type { StreamReport } from '../cloud-stream.ts';
import { ViewedStream } from '../viewed-stream.ts';
import { type PlannedLeaf, planLeaves } from './leaf-plan.ts';
import type { LeafPool, PlacedSplats } from './leaf-pool.ts';

/** Files that are fetched at once. */
export const FETCHED_AT_ONCE = 4;

/** The coarsest level of a leaf. */
interface CoarsestLevel {
  readonly leaf: number;
  readonly pieces: readonly SplatCells[];
}

/** A level of a leaf that has been decoded, and is about to be placed. */
interface ReadyLevel {
  readonly level: number;
  readonly pieces: readonly SplatCells[];
  /** Of the leaves that are a part of it. */
  readonly parts: readonly CoarsestLevel[];
}

/**
 * What is on the GPU of a leaf: its coarsest level, unless it is a part of one whose finest is not
 * there, and perhaps a finer one, which is drawn instead.
 */
interface PlacedLeaf {
  coarsest: PlacedSplats | null;
  finer: { readonly level: number; readonly splats: PlacedSplats } | null;
  ready: ReadyLevel | null;
  /** Leaves that are a part of it. */
  readonly parts: number[];
}

/**
 * Keeps that level of each leaf of a scene on the GPU that its views need most, beside the coarsest
 * one. One level of a leaf is drawn, and another takes its place between two frames.
 */
export class LeafStream extends ViewedStream {
  readonly #scene: LeafScene;
  #pool: LeafPool;
  /** By leaf, as many as are known. */
  readonly #placed: PlacedLeaf[] = [];
  /** Chunks for levels but the coarsest ones. */
  #roomChunks: number;
  #plan: readonly PlannedLeaf[] = [];
  /** Files that are fetched, decoded and taken, by number. */
  readonly #fetches = new Map<number, AbortController>();

  /** @param coarsest the coarsest level of each leaf, in `pool`, which has nothing else. */
  constructor(scene: LeafScene, pool: LeafPool, coarsest: readonly PlacedSplats[]) {
    super();
    this.#scene = scene;
    this.#pool = pool;
    this.#grow();
    for (const [i, splats] of coarsest.entries()) this.#placed[i].coarsest = splats;
    this.#roomChunks = pool.freeChunks;
    this.#replan();
  }

  report(): StreamReport {
    this.catchUp();
    const sum = (chunksOf: (placed: PlacedLeaf, i: number) => number) =>
      this.#placed.reduce((total, placed, i) => total + chunksOf(placed, i), 0);
    const missing = (_: PlacedLeaf, i: number) => this.#missingChunks(i, this.#plan[i]);
    return {
      bricks: sum((_, i) => this.#levelsOf(i).reduce((count, { chunkCount }) => count + chunkCount, 0)),
      residentBricks: this.#pool.chunkCells - this.#pool.freeChunks,
      mostBricks: this.#pool.chunkCells,
      missingBricks: sum(missing),
      refusedBricks: sum((placed, i) =>
        this.#plan[i]?.target === this.#plan[i]?.wanted ? 0 : missing(placed, i),
      ),
      fetching: this.#fetches.size,
      fetchedBytes: this.#scene.fetchedBytes,
      bytesPerSecond: this.#fetches.size > 0 ? this.rate.bytesPerSecond : 0,
      isComplete: this.isSeen && this.#placed.every((_, i) => !this.#isToChange(i)),
      error: this.error,
    };
  }

  missingFor(view: object): number {
    const plan = planLeaves(this.#scene.leaves, this.sightsOf(view), this.#roomChunks);
    return this.#placed.reduce((total, _, i) => total + this.#missingChunks(i, plan[i]), 0);
  }

  lackingCells(): Set<number> {
    this.catchUp();
    const lacking = this.#placed.filter((_, i) => this.#missingChunks(i, this.#plan[i]) > 0);
    const runs = lacking.flatMap(({ finer, coarsest }) => (finer?.splats ?? coarsest)?.runs ?? []);
    return new Set(runs.flatMap(({ cells, first }) => cells.map((_, i) => first + i)));
  }

  /** Makes room for more or fewer chunks; levels that are planned for these stay. */
  async resize(chunkCount: number): Promise<void> {
    await this.untilFree();
    if (this.isEnded) return;
    const { leaves } = this.#scene;
    const coarsest = this.#placed.reduce(
      (sum, placed, i) => sum + (leaves[i].above === undefined ? placed.coarsest!.chunkCount : 0),
      0,
    );
    this.#roomChunks = chunkCount - coarsest;
    this.#replan();
    for (const other of this.#unplanned()) {
      if (this.#pool.chunkCells - this.#pool.freeChunks <= chunkCount) break;
      if (this.#placed[other].finer) this.#coarsen(other);
    }
    this.#pool = this.#pool.resized(chunkCount);
    this.redraw();
  }

  override end(): void {
    for (const ending of this.#fetches.values()) ending.abort();
    super.end();
  }

  /** Plans anew, fetches what is missing, and ends other fetches. */
  protected follow(): void {
    if (this.isEnded) return;
    this.#grow();
    this.#replan();
    for (const [i, placed] of this.#placed.entries())
      if (placed.ready?.level !== this.#plan[i].target) placed.ready = null;
    const wanted = new Set(this.#missing().map((i) => this.#targetOf(i).file));
    for (const [file, ending] of this.#fetches) if (!wanted.has(file)) ending.abort();
    for (const file of wanted) {
      if (this.error || this.#fetches.size >= FETCHED_AT_ONCE) break;
      if (!this.#fetches.has(file)) void this.#bring(file);
    }
    this.settle(this.#fetches.size === 0);
  }

  protected whenDone(): Promise<unknown> {
    return this.#pool.whenDone();
  }

  protected get isWaiting(): boolean {
    return this.#placed.some((_, i) => this.#isPlaceable(i) || this.#isTooFine(i));
  }

  #replan(): void {
    this.#plan = planLeaves(this.#scene.leaves, this.sights, this.#roomChunks);
  }

  /** Leaves with a finer level that is not planned, those out of sight first, and parts before what they are in. */
  #unplanned(): number[] {
    const others = [...this.#placed.keys()].filter((i) => {
      const { finer } = this.#placed[i];
      return finer && finer.level !== this.#plan[i].target;
    });
    return others.sort((a, b) => Number(this.#plan[a].isSeen) - Number(this.#plan[b].isSeen) || b - a);
  }

  /** Takes in leaves that have been found. */
  #grow(): void {
    const { leaves } = this.#scene;
    for (let i = this.#placed.length; i < leaves.length; i++) {
      this.#placed.push({ coarsest: null, finer: null, ready: null, parts: [] });
      const { above } = leaves[i];
      if (above !== undefined) this.#placed[above].parts.push(i);
    }
  }

  #levelsOf(i: number): readonly LeafLevel[] {
    return this.#scene.leaves[i].levels;
  }

  /** Leaves whose planned level is neither there nor ready, the most valuable first. */
  #missing(): number[] {
    return [...this.#placed.keys()]
      .filter((i) => {
        const { target } = this.#plan[i];
        return this.#isMissing(i, target) && this.#placed[i].ready?.level !== target;
      })
      .sort((a, b) => this.#plan[b].value - this.#plan[a].value || a - b);
  }

  #targetOf(i: number): LeafLevel {
    return this.#levelsOf(i)[this.#plan[i].target];
  }

  /** Whether a level is to be fetched: finer than what is there, or coarser than what is seen. */
  #isMissing(i: number, level: number, { isSeen }: PlannedLeaf = this.#plan[i]): boolean {
    const coarsest = this.#coarsestOf(i);
    const shown = this.#placed[i].finer?.level ?? coarsest;
    return level < shown || (isSeen && level > shown && level < coarsest);
  }

  /** Chunks of the wanted level of a leaf, if it is not there; none before a view is known. */
  #missingChunks(i: number, plan: PlannedLeaf | undefined): number {
    return plan && this.#isMissing(i, plan.wanted, plan) ? this.#levelsOf(i)[plan.wanted].chunkCount : 0;
  }

  #coarsestOf(i: number): number {
    return this.#levelsOf(i).length - 1;
  }

  /** Whether a level of a leaf is ready, and what it is a part of is there. */
  #isPlaceable(i: number): boolean {
    return this.#placed[i].ready !== null && this.#placed[i].coarsest !== null;
  }

  /** Whether a leaf in sight is to be drawn at its coarsest level, and is not. */
  #isTooFine(i: number): boolean {
    const { isSeen, target } = this.#plan[i];
    return isSeen && this.#placed[i].finer !== null && target === this.#coarsestOf(i);
  }

  /** Whether another level of a leaf is to be drawn than the one that is. */
  #isToChange(i: number): boolean {
    return this.#isMissing(i, this.#plan[i].target) || this.#isTooFine(i);
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
        this.#placed[i].ready = await this.#decode(decoded, i, this.#plan[i].target, signal);
        this.follow();
      }
    } catch (error) {
      if (!signal.aborted) this.error = error as Error;
    }
    this.#fetches.delete(file);
    this.followSoon();
  }

  /** Makes ready a level of a leaf. */
  async #decode(decoded: LeafFile, i: number, level: number, signal: AbortSignal): Promise<ReadyLevel> {
    const { leaves } = this.#scene;
    const pieces = await decoded.pieces(leaves[i], leaves[i].levels[level], signal);
    // Leaves that have been found may take more room than there is.
    if (leaves.length > this.#placed.length) this.follow();
    const parts: CoarsestLevel[] = [];
    for (const leaf of level === 0 ? this.#placed[i].parts : [])
      parts.push({ leaf, pieces: await decoded.pieces(leaves[leaf], this.#levelsOf(leaf).at(-1)!, signal) });
    return { level, pieces, parts };
  }

  /** Draws what is ready, and what is planned and there. */
  protected change(mostParts: number): number {
    let placed = 0;
    let coarsened = 0;
    // Parts follow what they are a part of.
    for (const [i, { ready }] of this.#placed.entries()) {
      if (ready && this.#isPlaceable(i)) {
        if (placed >= mostParts) continue;
        this.#place(i, ready);
        placed++;
      } else if (this.#isTooFine(i)) {
        this.#coarsen(i);
        coarsened++;
      }
    }
    return placed + coarsened;
  }

  #place(i: number, { level, pieces, parts }: ReadyLevel): void {
    const placed = this.#placed[i];
    placed.ready = null;
    const chunkCount = [...pieces, ...parts.flatMap((part) => part.pieces)].reduce(
      (sum, { cells }) => sum + cells.length,
      0,
    );
    if (placed.finer) this.#strip(i);
    else this.#pool.show(placed.coarsest!, false);
    // All that is planned has room: so what is not goes.
    for (const other of this.#unplanned()) {
      if (this.#pool.freeChunks >= chunkCount) break;
      if (this.#placed[other].finer) this.#coarsen(other);
    }
    placed.finer = { level, splats: this.#pool.place(pieces, level) };
    for (const part of parts)
      this.#placed[part.leaf].coarsest = this.#pool.place(part.pieces, this.#coarsestOf(part.leaf));
  }

  /** Draws the coarsest level of a leaf instead of a finer one. */
  #coarsen(i: number): void {
    this.#strip(i);
    this.#pool.show(this.#placed[i].coarsest!, true);
  }

  /** Takes out the finer level of a leaf, with all that is a part of it. */
  #strip(i: number): void {
    const placed = this.#placed[i];
    for (const part of placed.parts) {
      const { coarsest, finer } = this.#placed[part];
      if (finer) this.#strip(part);
      if (coarsest) this.#pool.remove(coarsest);
      this.#placed[part].coarsest = null;
      this.#placed[part].ready = null;
    }
    this.#pool.remove(placed.finer!.splats);
    placed.finer = null;
  }
}
