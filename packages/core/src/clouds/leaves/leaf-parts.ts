import type { LeafFile, LeafLevel, LeafScene, SplatCells } from '../../data/bricks/leaf-scene.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { chunksWithoutBounds, STREAM_PRECISION } from '../stream/chunk-pages.ts';
import type { CloudSight } from '../stream/cloud-sight.ts';
import type { CoarseSplats, SplatSpan } from '../stream/cloud-stream.ts';
import type { MissingPart, PartEvents, SceneParts } from '../stream/scene-stream.ts';
import type { PartLimit, Sights } from '../stream/scene-viewers.ts';
import { type PlannedLeaf, planLeaves } from './leaf-plan.ts';
import type { LeafPool, PlacedSplats } from './leaf-pool.ts';

/**
 * Batches of one file that are packed at a time. While views move, one waits while a worker packs
 * another, since they may come to need others. At rest, so many that several workers share them.
 */
const PACKED_AT_ONCE = { moving: 2, atRest: 8 } as const;
/** Splats from which on a batch is full: a worker packs them in some ten milliseconds. */
const BATCH_SPLATS = 1 << 14;
/**
 * Room besides that of the planned levels, as a share of the latter. It holds old levels of leaves
 * until their new ones are placed, and levels of leaves that have left the view but may return.
 */
const SPARE_ROOM = 1 / 4;
/** Least growth of a pool, as a share of it: frames draw each addition by itself. */
const LEAST_GROWTH = 1 / 4;

/** A piece of a leaf's splats. */
interface LeafPiece {
  readonly leaf: number;
  readonly piece: SplatCells;
}

/** A packed level of a leaf. It is drawn once all of its pieces have been placed. */
interface ReadyLevel {
  readonly level: number;
  /** Pieces to place. With the finest level come the coarsest levels of the leaf's children. */
  readonly waiting: LeafPiece[];
  /** Placed pieces, by leaf. */
  readonly placed: ReadonlyMap<number, PlacedSplats[]>;
}

/**
 * The resident levels of a leaf. Its coarsest level is resident unless its parent's finest is not.
 * The planned level may be resident, and earlier ones stay while there is room.
 */
interface PlacedLeaf {
  /** By level; null if not resident. */
  readonly levels: (PlacedLevel | null)[];
  /** Null if the parent's finest level is not drawn. */
  drawn: number | null;
  ready: ReadyLevel | null;
  /** Indices of the children. */
  readonly parts: number[];
}

interface PlacedLevel {
  readonly splats: readonly PlacedSplats[];
  /** The upload in which it was last drawn. */
  lastUpload: number;
}

/**
 * The levels of the leaves of a scene, fetched file by file. The coarsest level of each leaf stays.
 * Other levels stay cached while there is room, in case views turn back. One level of a leaf is drawn
 * at a time.
 */
export class LeafParts implements SceneParts<MissingPart> {
  /** The planned levels alone keep the budget. */
  readonly needsShift = false;
  readonly #scene: LeafScene;
  #pool: LeafPool;
  readonly #chunksIn: (bytes: number) => number;
  /** By leaf, for all leaves found so far. */
  readonly #placed: PlacedLeaf[] = [];
  /** Splats of each file in all leaves found so far, which its size goes with. */
  readonly #splatsOf = new Map<number, number>();
  /** Most chunks that the pool may have. */
  #mostChunks: number;
  /** Chunks for all levels but the coarsest ones. */
  #roomChunks: number;
  #plan: readonly PlannedLeaf[] = [];
  /**
   * The level of each leaf to be drawn. It is the planned one, but while views move, nothing is fetched
   * or packed that they would pass by before it is there.
   */
  #targets: readonly number[] = [];
  /** Files that are being fetched or packed. */
  readonly #fetching = new Set<number>();
  /** Inputs of `#plan`: while they are the same, so is the plan. */
  #planned: {
    readonly sights: readonly CloudSight[];
    readonly predicted: readonly CloudSight[];
    readonly leaves: number;
    readonly room: number;
  } | null = null;
  #uploads = 0;
  /** How long the last upload's merge took on the thread, divided by the number of placed pieces, ms. */
  #mergeMs = 0;

  /**
   * @param bytes of the scene's share of GPU memory.
   * @param chunksIn the chunks of a pool of this many bytes.
   * @param coarsest the coarsest level of each leaf, the only contents of `pool`.
   */
  constructor(
    scene: LeafScene,
    pool: LeafPool,
    bytes: number,
    chunksIn: (bytes: number) => number,
    coarsest: readonly (readonly PlacedSplats[])[],
  ) {
    this.#scene = scene;
    this.#pool = pool;
    this.#chunksIn = chunksIn;
    this.#addLeaves();
    for (const [i, splats] of coarsest.entries()) this.#take(i, this.#coarsestOf(i), splats);
    this.#mostChunks = chunksIn(bytes);
    this.#roomChunks = this.#mostChunks - this.#coarsestChunks;
    this.#replan({ sights: [], predicted: [] });
  }

  plan(sights: Sights): readonly MissingPart[] {
    this.#replan(sights);
    this.#dropUnplanned();
    return this.#filesByWorth().map((number) => ({ number, isNeeded: true, fits: true }));
  }

  /** Files with missing levels; first the one that removes the most error for its size. */
  #filesByWorth(): number[] {
    const worths = new Map<number, number>();
    for (const i of this.#missing()) {
      const { file, count } = this.#targetOf(i);
      worths.set(file, (worths.get(file) ?? 0) + this.#plan[i].value * count);
    }
    const worthOf = (file: number) => worths.get(file)! / this.#splatsOf.get(file)!;
    return [...worths.keys()].sort((a, b) => worthOf(b) - worthOf(a) || a - b);
  }

  /** Adds leaves that the scene has found meanwhile. */
  #addLeaves(): void {
    const { leaves } = this.#scene;
    for (let i = this.#placed.length; i < leaves.length; i++) {
      const { above, levels } = leaves[i];
      this.#placed.push({ levels: levels.map(() => null), drawn: null, ready: null, parts: [] });
      for (const { file, count } of levels) this.#splatsOf.set(file, (this.#splatsOf.get(file) ?? 0) + count);
      if (above !== undefined) this.#placed[above].parts.push(i);
    }
  }

  #replan({ sights, predicted }: Pick<Sights, 'sights' | 'predicted'>): void {
    this.#addLeaves();
    const { leaves } = this.#scene;
    const planned = { sights, predicted, leaves: leaves.length, room: this.#roomChunks };
    if (this.#planned && hasSameFields(this.#planned, planned)) return;
    this.#planned = planned;
    this.#plan = planLeaves(leaves, sights, this.#roomChunks);
    const areAtHand = this.#plan.every(({ target }, i) => this.#isAtHand(i, target));
    const ahead =
      areAtHand || predicted.length === 0 ? null : planLeaves(leaves, predicted, this.#roomChunks);
    this.#targets = this.#plan.map(({ target }, i) =>
      this.#targetUntil(i, target, ahead?.[i].target ?? target),
    );
  }

  /**
   * The level of a leaf that is planned now, unless a coarser one is planned for soon; then the finest
   * one between them that is at hand.
   */
  #targetUntil(i: number, now: number, soon: number): number {
    let level = now;
    while (level < soon && !this.#isAtHand(i, level)) level++;
    return level;
  }

  /** Whether a level is resident, packed or being fetched. */
  #isAtHand(i: number, level: number): boolean {
    const { levels, ready } = this.#placed[i];
    return (
      levels[level] !== null || ready?.level === level || this.#fetching.has(this.#levelsOf(i)[level].file)
    );
  }

  get isHolding(): boolean {
    return this.#plan.some(({ target }, i) => target !== this.#targets[i]);
  }

  /** Chunks of the coarsest levels that always stay. */
  get #coarsestChunks(): number {
    const { leaves } = this.#scene;
    return this.#placed.reduce(
      (sum, { levels }, i) => sum + (leaves[i].above === undefined ? chunkCountOf(levels.at(-1)!.splats) : 0),
      0,
    );
  }

  /** Chunks that the pool needs for the plan, with room to spare. */
  get #plannedChunks(): number {
    const planned = this.#targets.reduce((sum, target, i) => {
      const isCoarsest = target === this.#coarsestOf(i) && this.#scene.leaves[i].above === undefined;
      return isCoarsest ? sum : sum + this.#levelsOf(i)[target].chunkCount;
    }, this.#coarsestChunks);
    return Math.min(this.#mostChunks, Math.ceil(planned * (1 + SPARE_ROOM)));
  }

  /** Removes partly placed levels that are no longer planned. */
  #dropUnplanned(): void {
    for (const [i, { ready }] of this.#placed.entries())
      if (ready && ready.level !== this.#targets[i]) this.#drop(i);
  }

  /** Leaves whose planned level is neither resident nor decoded, the most valuable first. */
  #missing(): number[] {
    return [...this.#placed.keys()]
      .filter((i) => {
        const target = this.#targets[i];
        const { levels, ready } = this.#placed[i];
        return this.#isBetter(i, target) && levels[target] === null && ready?.level !== target;
      })
      .sort((a, b) => this.#plan[b].value - this.#plan[a].value || a - b);
  }

  #targetOf(i: number): LeafLevel {
    return this.#levelsOf(i)[this.#targets[i]];
  }

  /** Whether a level should replace the drawn one: it is finer, or coarser and in sight. */
  #isBetter(i: number, level: number, { isInSight }: PlannedLeaf = this.#plan[i]): boolean {
    const drawn = this.#placed[i].drawn ?? this.#coarsestOf(i);
    return level < drawn || (isInSight && level > drawn);
  }

  #levelsOf(i: number): readonly LeafLevel[] {
    return this.#scene.leaves[i].levels;
  }

  #coarsestOf(i: number): number {
    return this.#levelsOf(i).length - 1;
  }

  requestWith(first: MissingPart): readonly MissingPart[] {
    return [first];
  }

  /** Fetches a file and packs its missing levels. */
  async fetch({ number: file }: MissingPart, signal: AbortSignal, events: PartEvents): Promise<void> {
    this.#fetching.add(file);
    try {
      await this.#packMissing(file, await this.#scene.read(file, signal, events.onBytes), signal, events);
    } finally {
      this.#fetching.delete(file);
    }
    events.onSettled(file);
  }

  /** Packs the missing levels of a file, including levels that views ask for while it packs. */
  async #packMissing(number: number, file: LeafFile, signal: AbortSignal, events: PartEvents): Promise<void> {
    const underWay = new Set<number>();
    const next = () => {
      const left = this.#missing().filter((i) => this.#targetOf(i).file === number && !underWay.has(i));
      return firstBatch(left, (i) => this.#targetOf(i).count);
    };
    const packMissing = async () => {
      for (let batch = next(); batch.length > 0; batch = next()) {
        for (const i of batch) underWay.add(i);
        await this.#pack(file, batch, signal, events);
        for (const i of batch) underWay.delete(i);
        events.onProgress();
      }
    };
    const isMoving = this.#planned!.predicted.length > 0;
    const length = PACKED_AT_ONCE[isMoving ? 'moving' : 'atRest'];
    await Promise.all(Array.from({ length }, packMissing));
  }

  /** Packs the planned levels of some leaves, and makes them ready. */
  async #pack(
    file: LeafFile,
    batch: readonly number[],
    signal: AbortSignal,
    events: PartEvents,
  ): Promise<void> {
    const { leaves } = this.#scene;
    const targets = batch.map((i) => this.#targets[i]);
    const own = batch.map((i, at) => ({ leaf: leaves[i], level: this.#levelsOf(i)[targets[at]] }));
    const packed = await file.pack(own, signal);
    // Leaves found by packing may exceed the planned room.
    if (leaves.length > this.#placed.length) events.onProgress();
    const parts = batch.flatMap((i, at) => (targets[at] === 0 ? this.#placed[i].parts : []));
    const coarsest = parts.map((leaf) => ({ leaf: leaves[leaf], level: this.#levelsOf(leaf).at(-1)! }));
    const packedParts = parts.length > 0 ? await file.pack(coarsest, signal) : [];
    const piecesOf = new Map(parts.map((leaf, at) => [leaf, packedParts[at]]));
    for (const [at, i] of batch.entries()) {
      const below = targets[at] === 0 ? this.#placed[i].parts : [];
      const all = [[i, packed[at]] as const, ...below.map((leaf) => [leaf, piecesOf.get(leaf)!] as const)];
      const waiting = all.flatMap(([leaf, pieces]) => pieces.map((piece) => ({ leaf, piece })));
      this.#drop(i);
      this.#placed[i].ready = {
        level: targets[at],
        waiting,
        placed: new Map(all.map(([leaf]) => [leaf, []])),
      };
    }
  }

  get isWaiting(): boolean {
    return this.#placed.some((_, i) => this.#isPlaceable(i) || this.#isDrawable(i));
  }

  /** Whether a level of a leaf is decoded and its parent is drawn. */
  #isPlaceable(i: number): boolean {
    return this.#placed[i].ready !== null && this.#placed[i].drawn !== null;
  }

  /** Whether the planned level of a leaf is resident and should replace the drawn one. */
  #isDrawable(i: number): boolean {
    const { levels, drawn } = this.#placed[i];
    const target = this.#targets[i];
    return drawn !== null && levels[target] !== null && this.#isBetter(i, target);
  }

  /** Places packed levels in the pool and draws them, as well as planned levels that are resident. */
  upload({ parts: mostPieces, ms }: PartLimit): number {
    const beganMs = performance.now();
    this.#uploads++;
    // Counted in full pieces.
    let placed = 0;
    let hasDrawn = false;
    const mayPlace = () => {
      const placedMs = performance.now() - beganMs + placed * this.#mergeMs;
      return placed === 0 || (placed < mostPieces && placedMs < ms);
    };
    // Parents before their children.
    for (const [i, { ready }] of this.#placed.entries()) {
      if (ready && this.#isPlaceable(i)) {
        while (ready.waiting.length > 0 && mayPlace()) placed += this.#placeNext(ready, i);
        if (ready.waiting.length > 0) continue;
        this.#drawReady(ready, i);
        hasDrawn = true;
      } else if (this.#isDrawable(i)) {
        this.#draw(i, this.#targets[i]);
        hasDrawn = true;
      }
    }
    const placedMs = performance.now();
    this.#pool.merge();
    if (placed > 0) this.#mergeMs = (performance.now() - placedMs) / Math.max(1, placed);
    return Math.max(Math.ceil(placed), Number(hasDrawn));
  }

  /** Places a piece of a packed level of leaf `i`; returns which part of a full one it is. */
  #placeNext({ level, waiting, placed }: ReadyLevel, i: number): number {
    const { leaf, piece } = waiting.shift()!;
    // The plan fits the pool: if the pool is full, it holds levels that are not planned any more.
    this.#makeRoom(piece.cells.length);
    placed.get(leaf)!.push(this.#pool.place(piece, leaf === i ? level : this.#coarsestOf(leaf)));
    return piece.cells.length / LEVEL_CONSTANTS.CELL_CHILDREN;
  }

  /** Draws a level of leaf `i` all of whose pieces have been placed. */
  #drawReady({ level, placed }: ReadyLevel, i: number): void {
    this.#hide(i);
    for (const [leaf, splats] of placed)
      this.#take(leaf, leaf === i ? level : this.#coarsestOf(leaf), splats);
    this.#placed[i].ready = null;
  }

  /**
   * Makes room for this many chunks: the pool grows as the plan needs it, within its budget, or
   * unplanned levels are evicted. Hidden levels go first, the least recently drawn one first; then
   * drawn levels, out of sight before in sight.
   */
  #makeRoom(chunkCount: number): void {
    if (this.#pool.freeChunks >= chunkCount) return;
    const { chunkCount: held } = this.#pool;
    const planned = this.#plannedChunks;
    if (planned > held) {
      const wanted = Math.max(planned, Math.ceil(held * (1 + LEAST_GROWTH)));
      this.#pool.growTo(Math.min(this.#mostChunks, wanted));
      if (this.#pool.freeChunks >= chunkCount) return;
    }
    const others = this.#placed.flatMap(({ levels, drawn }, leaf) => {
      const target = this.#targets[leaf];
      const { isInSight } = this.#plan[leaf];
      return levels.flatMap((placed, level) => {
        if (!placed || level === target || level === this.#coarsestOf(leaf)) return [];
        const lastUpload = level === drawn ? this.#uploads + 1 + Number(isInSight) : placed.lastUpload;
        return [{ leaf, level, lastUpload }];
      });
    });
    // Children before their parents.
    others.sort((a, b) => a.lastUpload - b.lastUpload || b.leaf - a.leaf);
    for (const { leaf, level } of others) {
      if (this.#pool.freeChunks >= chunkCount) return;
      // It may have been removed with its parent.
      if (this.#placed[leaf].levels[level]) this.#remove(leaf, level);
    }
  }

  /** Registers a placed level of a leaf, and draws it. */
  #take(i: number, level: number, splats: readonly PlacedSplats[]): void {
    this.#placed[i].levels[level] = { splats, lastUpload: this.#uploads };
    this.#placed[i].drawn = level;
    this.#show(splats, true);
  }

  /** Draws a resident level of a leaf in place of the current one. */
  #draw(i: number, level: number): void {
    this.#hide(i);
    const { levels, parts } = this.#placed[i];
    this.#show(levels[level]!.splats, true);
    this.#placed[i].drawn = level;
    if (level === 0) for (const part of parts) this.#draw(part, this.#coarsestOf(part));
  }

  /** Hides a leaf and its descendants. */
  #hide(i: number): void {
    const { levels, drawn, parts } = this.#placed[i];
    if (drawn === null) return;
    const placed = levels[drawn]!;
    placed.lastUpload = this.#uploads;
    this.#show(placed.splats, false);
    this.#placed[i].drawn = null;
    if (drawn === 0) for (const part of parts) this.#hide(part);
  }

  #show(splats: readonly PlacedSplats[], isShown: boolean): void {
    for (const each of splats) this.#pool.show(each, isShown);
  }

  /**
   * Removes a level of a leaf. Without its finest level, its descendants are removed too. If it was
   * drawn, the coarsest level is drawn instead.
   */
  #remove(i: number, level: number): void {
    const { levels, drawn, parts } = this.#placed[i];
    if (level === drawn) this.#draw(i, this.#coarsestOf(i));
    for (const each of levels[level]!.splats) this.#pool.remove(each);
    levels[level] = null;
    if (level > 0) return;
    for (const part of parts) {
      const { levels } = this.#placed[part];
      this.#drop(part);
      for (let each = levels.length - 1; each >= 0; each--) if (levels[each]) this.#remove(part, each);
    }
  }

  #drop(i: number): void {
    const splats = [...(this.#placed[i].ready?.placed.values() ?? [])].flat();
    for (const each of splats) this.#pool.remove(each);
    this.#placed[i].ready = null;
  }

  resize(bytes: number, sights: Sights): void {
    this.#mostChunks = this.#chunksIn(bytes);
    this.#roomChunks = this.#mostChunks - this.#coarsestChunks;
    this.#replan(sights);
    this.#dropUnplanned();
    if (this.#mostChunks >= this.#pool.chunkCount) return;
    this.#makeRoom(this.#pool.chunkCount - this.#mostChunks);
    this.#pool = this.#pool.shrunkTo(this.#mostChunks);
  }

  whenDone(): Promise<unknown> {
    return this.#pool.whenDone();
  }

  end(): void {
    this.#scene.end();
  }

  report(): ReturnType<SceneParts<MissingPart>['report']> {
    const sum = (chunksOf: (placed: PlacedLeaf, i: number) => number) =>
      this.#placed.reduce((total, placed, i) => total + chunksOf(placed, i), 0);
    const missing = (_: PlacedLeaf, i: number) => this.#missingChunks(i, this.#plan[i]);
    return {
      bricks: sum((_, i) => this.#levelsOf(i).reduce((count, { chunkCount }) => count + chunkCount, 0)),
      residentBricks: this.#pool.chunkCount - this.#pool.freeChunks,
      mostBricks: this.#mostChunks,
      missingBricks: sum(missing),
      refusedBricks: sum((placed, i) =>
        this.#plan[i]?.target === this.#plan[i]?.wanted ? 0 : missing(placed, i),
      ),
      fetchedBytes: this.#scene.fetchedBytes,
      keptBytes: this.#scene.keptBytes,
      isComplete: this.#placed.every((_, i) => !this.#isBetter(i, this.#plan[i].target)),
    };
  }

  /** Chunks of the wanted level of a leaf if another is drawn; 0 without a plan. */
  #missingChunks(i: number, plan: PlannedLeaf | undefined): number {
    if (!plan || plan.wanted === this.#coarsestOf(i) || !this.#isBetter(i, plan.wanted, plan)) return 0;
    return this.#levelsOf(i)[plan.wanted].chunkCount;
  }

  missingFor(sights: readonly CloudSight[]): number {
    const plan = planLeaves(this.#scene.leaves, sights, this.#roomChunks);
    return this.#placed.reduce((total, _, i) => total + this.#missingChunks(i, plan[i]), 0);
  }

  lackingCells(): Set<number> {
    const lacking = this.#placed.filter((_, i) => this.#missingChunks(i, this.#plan[i]) > 0);
    const runs = lacking.flatMap(({ levels, drawn }) =>
      drawn === null ? [] : levels[drawn]!.splats.flatMap((each) => each.runs),
    );
    return new Set(runs.flatMap(({ cells, first }) => cells.map((_, i) => first + i)));
  }

  /** The coarsest levels of leaves without a parent, which always stay resident. */
  async coarse(): Promise<CoarseSplats> {
    const spans = () =>
      this.#placed.flatMap(({ levels }, i) => {
        if (this.#scene.leaves[i].above !== undefined) return [];
        return levels.at(-1)!.splats.flatMap(({ runs }) => runs.map(spanOf));
      });
    const count = spans().reduce((sum, span) => sum + span.count, 0);
    return { count, precision: STREAM_PRECISION.geometryPrecision, words: null, spans };
  }
}

/** The first of some leaves, up to a full batch: one call packs them. */
export function firstBatch(leaves: readonly number[], splatsOf: (leaf: number) => number): readonly number[] {
  let splats = 0;
  const end = leaves.findIndex((leaf) => {
    const isFull = splats >= BATCH_SPLATS;
    splats += splatsOf(leaf);
    return isFull;
  });
  return end < 0 ? leaves : leaves.slice(0, end);
}

function spanOf({ cells, first }: PlacedSplats['runs'][number]): SplatSpan {
  const count = CHUNK_SPLATS * cells.length;
  return { first: CHUNK_SPLATS * first, count, chunks: chunksWithoutBounds(cells) };
}

function chunkCountOf(splats: readonly PlacedSplats[]): number {
  return splats.reduce((sum, { chunkCount }) => sum + chunkCount, 0);
}
