import type { Brick, BrickAddress, BrickScene } from '../../data/bricks/brick.ts';
import { MOST_REQUEST_BYTES } from '../../data/bricks/brick-files.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { BLOB_PRECISION } from '../../data/packing/precision.ts';
import { STREAM_PRECISION } from '../stream/chunk-pages.ts';
import type { CloudSight } from '../stream/cloud-sight.ts';
import type { StreamReport } from '../stream/cloud-stream.ts';
import { type CoarseSplats, chunksWithoutBounds } from '../stream/coarse-splats.ts';
import { ViewedStream } from '../stream/viewed-stream.ts';
import {
  BrickPlan,
  DRAWN,
  isWorthMore,
  type LackingBrick,
  type ResidentBrick,
  type ValuedBrick,
} from './brick-plan.ts';
import type { BrickPool, PlacedBrick, PlacedCell, PoolSlots } from './brick-pool.ts';

/** Concurrent requests; each fetches a run of adjacent bricks. */
const FETCHED_AT_ONCE = 4;
/**
 * Fetched bricks that may wait in memory while the pool must not change; a few hundred kilobytes
 * each.
 */
const MOST_ARRIVED = 32;
/** Most bytes of bricks, the root included, that are requested before the first picture. */
const MOST_BYTES_AT_FIRST = 3 << 19;

interface Fetch {
  readonly above: PlacedCell;
  /** Adjacent bricks of one request, this one included. */
  readonly run: readonly LackingBrick[];
  readonly ending: AbortController;
  /** Null until fetched. */
  brick: Brick | null;
}

/**
 * Keeps the bricks of a scene on the GPU that views need most. Parents are placed before children,
 * and children removed before parents. So every part of the scene is always drawn, coarser while
 * bricks are missing.
 */
export class BrickStream extends ViewedStream {
  readonly #scene: BrickScene;
  #pool: BrickPool;
  readonly #root: PlacedBrick;
  /** The demand of the current sights, cached; null before the first one. */
  #cachedDemand: {
    readonly sights: readonly CloudSight[];
    readonly predicted: readonly CloudSight[];
    readonly demand: BrickPlan;
  } | null = null;
  /** By brick number, until the brick is placed. */
  readonly #fetches = new Map<number, Fetch>();
  #missing: readonly LackingBrick[] = [];
  #refused = 0;
  #fetchedBytes: number;
  #requestedBytes: number;
  /**
   * By brick number: bricks being read, and bricks already read by `coarse`. Cleared once the views
   * lack nothing.
   */
  readonly #reads = new Map<number, Promise<Brick>>();
  #coarse: CoarseSplats | null = null;

  /** @param root the root of `scene`, in `pool`. */
  constructor(scene: BrickScene, pool: BrickPool, root: PlacedBrick) {
    super();
    this.#scene = scene;
    this.#pool = pool;
    this.#root = root;
    this.#fetchedBytes = scene.root.bytes;
    this.#requestedBytes = scene.root.bytes;
    // The shaders compile early. If they fail, placing the first brick reports it.
    pool.ready(0).catch(() => {});
  }

  report(): StreamReport {
    this.flushUpdate();
    const { lowest, upper } = this.#pool.slots;
    return {
      bricks: this.#scene.brickCount,
      residentBricks: this.#pool.bricks.length,
      mostBricks: lowest + upper,
      missingBricks: this.#missing.length,
      refusedBricks: this.#refused,
      fetching: this.#fetches.size,
      fetchedBytes: this.#fetchedBytes,
      bytesPerSecond: this.#fetches.size > 0 ? this.rate.bytesPerSecond : 0,
      isComplete: this.hasSights && this.#missing.length === this.#refused,
      error: this.error,
    };
  }

  missingFor(view: object): number {
    return new BrickPlan(this.sightsOf(view)).lacking(this.#root).length;
  }

  lackingCells(): Set<number> {
    this.flushUpdate();
    return new Set(this.#missing.map(({ above }) => above.cell));
  }

  /**
   * Leaves of the finest level whose bricks take at most MOST_BYTES_AT_FIRST bytes; independent of
   * the views.
   */
  async coarse(signal?: AbortSignal): Promise<CoarseSplats> {
    this.#coarse ??= coarseSplats(await this.#coarseBricks(signal));
    return this.#coarse;
  }

  async #coarseBricks(signal: AbortSignal | undefined): Promise<readonly Brick[]> {
    let bricks: readonly Brick[] = [];
    let below = addressesBelow(this.#root);
    // The root alone, 256 blobs, is too coarse.
    while (below.length > 0 && (bricks.length === 0 || bytesOf(below) <= MOST_BYTES_AT_FIRST)) {
      bricks = await Promise.all(below.map((address) => this.#read(address, signal)));
      below = bricks.flatMap(addressesBelow);
    }
    return bricks.length > 0 ? bricks : [await this.#scene.read(this.#scene.root, signal)];
  }

  /** Reads a brick once, shared by concurrent callers. */
  async #read(address: BrickAddress, signal: AbortSignal | undefined): Promise<Brick> {
    const { number, bytes } = address;
    const other = this.#reads.get(number);
    if (other) {
      const brick = await other.catch(() => null);
      if (brick) return brick;
      // The read may have failed only because the other caller aborted it.
      signal?.throwIfAborted();
    }
    const reading = this.#scene.read(address, signal);
    this.#reads.set(number, reading);
    try {
      const brick = await reading;
      this.#fetchedBytes += bytes;
      this.rate.take(bytes);
      return brick;
    } catch (error) {
      if (this.#reads.get(number) === reading) this.#reads.delete(number);
      throw error;
    }
  }

  /** Resizes the pool; the most valuable bricks stay. */
  async resize(slots: PoolSlots): Promise<void> {
    await this.untilFree();
    if (this.isEnded) return;
    const demand = this.#demand;
    for (const isLowest of [true, false]) {
      const placed = () => this.#pool.bricks.filter(({ level }) => (level === 0) === isLowest);
      const most = isLowest ? slots.lowest : slots.upper;
      // The least valuable first, so that children go before their parents.
      const ranked = demand.ranked(placed());
      for (const { brick } of ranked.slice(0, Math.max(0, placed().length - most))) this.#pool.remove(brick);
    }
    this.#pool = this.#pool.resized(slots);
    this.redraw();
  }

  override end(): void {
    for (const { ending } of this.#fetches.values()) ending.abort();
    this.#scene.end();
    super.end();
  }

  get #demand(): BrickPlan {
    const { sights, predicted } = this;
    if (this.#cachedDemand?.sights !== sights || this.#cachedDemand.predicted !== predicted)
      this.#cachedDemand = { sights, predicted, demand: new BrickPlan(sights, predicted) };
    return this.#cachedDemand.demand;
  }

  /**
   * Fetches bricks that views lack, then bricks that they are about to lack, and aborts all other
   * fetches.
   */
  protected update(): void {
    if (this.isEnded) return;
    const lacking = this.#demand.lacking(this.#root, true);
    const wanted = new Set(lacking.map(({ number }) => number));
    for (const [number, { ending }] of this.#fetches) if (!wanted.has(number)) ending.abort();
    this.#missing = lacking.filter(isNeeded);
    const possible = this.#fitting(lacking);
    const needed = possible.filter(isNeeded);
    this.#refused = this.#missing.length - needed.length;
    if (!this.error) {
      this.#fetchRuns(needed, this.#neededFetches);
      if (needed.every(({ number }) => this.#fetches.has(number)))
        this.#fetchRuns(possible.slice(needed.length), [...this.#fetches.values()]);
    }
    const waitsForPicture =
      !this.isPictured && !this.error && !needed.every(({ number }) => this.#fetches.has(number));
    if (this.hasSights && lacking.length === 0) this.#reads.clear();
    const fetches = this.error ? this.#fetches.size : this.#neededFetches.length;
    this.setIdle(fetches === 0 && !waitsForPicture);
  }

  /** Fetches of bricks that views need now, and aborted fetches that have not ended. */
  get #neededFetches(): readonly Fetch[] {
    return [...this.#fetches.values()].filter(
      ({ above, ending }) => ending.signal.aborted || isNeeded(valued(this.#demand, above)),
    );
  }

  /**
   * Fetches the most valuable bricks, each in one request with adjacent missing bricks. Before the
   * first picture the requests stay small: further bytes would delay it on slow networks.
   *
   * @param others fetches that count towards the limit of concurrent ones.
   */
  #fetchRuns(wanted: readonly LackingBrick[], others: readonly Fetch[]): void {
    const waiting = wanted.filter(({ number }) => !this.#fetches.has(number));
    const fetching = new Set(others.flatMap(({ run, brick }) => (brick ? [] : [run])));
    let places = MOST_ARRIVED - others.length;
    for (const best of waiting) {
      if (fetching.size >= FETCHED_AT_ONCE || places <= 0) return;
      if (this.#fetches.has(best.number)) continue;
      const bytesLeft = this.isPictured
        ? MOST_REQUEST_BYTES
        : Math.min(MOST_REQUEST_BYTES, MOST_BYTES_AT_FIRST - this.#requestedBytes);
      if (addressOf(best).bytes > bytesLeft && !this.isPictured) return;
      const run = runAround(
        best,
        waiting.filter(({ number }) => !this.#fetches.has(number)),
        places,
        bytesLeft,
      );
      fetching.add(run);
      places -= run.length;
      for (const { above } of run) void this.#fetch(above, run);
    }
  }

  /** The missing bricks that fit: into free slots, or into slots of less valuable bricks. */
  #fitting(lacking: readonly LackingBrick[]): readonly LackingBrick[] {
    const kinds = [0, 1].map((level) => ({
      level,
      taken: 0,
      free: this.#pool.freeSlots(level),
      // Ranking is expensive, and needed only if no slot is free.
      others: null as readonly ResidentBrick[] | null,
    }));
    return lacking.filter((each) => {
      const kind = kinds[each.above.brick.level === 1 ? 0 : 1];
      const place = kind.taken++ - kind.free;
      if (place < 0) return true;
      kind.others ??= this.#ranked(kind.level);
      return place < kind.others.length && isWorthMore(each, kind.others[place]);
    });
  }

  async #fetch(above: PlacedCell, run: readonly LackingBrick[]): Promise<void> {
    const address = above.child!;
    const ending = new AbortController();
    const fetch: Fetch = { above, run, ending, brick: null };
    if (this.#fetches.size === 0) this.rate.begin();
    this.#fetches.set(address.number, fetch);
    this.#requestedBytes += address.bytes;
    try {
      const brick = await this.#read(address, ending.signal);
      await this.#pool.ready(brick.level);
      fetch.brick = brick;
      this.#reads.delete(address.number);
    } catch (error) {
      this.#fetches.delete(address.number);
      if (!ending.signal.aborted) this.error = error as Error;
    }
    this.updateSoon();
  }

  protected whenDone(): Promise<unknown> {
    return this.#pool.whenDone();
  }

  protected get isWaiting(): boolean {
    return this.#arrived.length > 0;
  }

  /** Fetched bricks that wait to be placed. */
  get #arrived(): readonly (Fetch & { readonly brick: Brick })[] {
    return [...this.#fetches.values()].filter(
      (fetch): fetch is Fetch & { brick: Brick } => fetch.brick !== null,
    );
  }

  protected applyPending(mostParts: number): number {
    const worth = ({ above }: Fetch) => valued(this.#demand, above);
    const arrived = this.#arrived.toSorted((a, b) => (isWorthMore(worth(a), worth(b)) ? -1 : 1));
    let placed = 0;
    for (const { brick, above, ending } of arrived) {
      this.#fetches.delete(above.child!.number);
      if (ending.signal.aborted) continue;
      try {
        placed += Number(this.#take(brick, above));
      } catch (error) {
        // The brick contradicts the resident ones.
        this.error = error as Error;
      }
      if (placed >= mostParts) break;
    }
    return placed;
  }

  /** Places a fetched brick if it is still worth its room; returns whether it was placed. */
  #take(brick: Brick, above: PlacedCell): boolean {
    // The parent may have been removed since the fetch began.
    if (!isPlaced(above)) return false;
    const isFull = this.#pool.freeSlots(brick.level) === 0;
    const least = isFull ? this.#ranked(brick.level)[0] : null;
    if (isFull && !(least && isWorthMore(valued(this.#demand, above), least))) return false;
    this.#pool.place(brick, above.child!, above, least?.brick);
    return true;
  }

  /**
   * Resident bricks that use the same kind of slot as `level`, without the root, the least valuable
   * first.
   */
  #ranked(level: number): readonly ResidentBrick[] {
    return this.#demand.ranked(this.#pool.bricks.filter((brick) => (brick.level === 0) === (level === 0)));
  }
}

function addressesBelow({ cells }: Pick<Brick | PlacedBrick, 'cells'>): BrickAddress[] {
  return cells.flatMap(({ child }) => child ?? []);
}

function bytesOf(addresses: readonly BrickAddress[]): number {
  return addresses.reduce((sum, { bytes }) => sum + bytes, 0);
}

/** The leaves of bricks of one level. */
function coarseSplats(bricks: readonly Brick[]): CoarseSplats {
  const cells = bricks.flatMap((brick) => brick.cells);
  const words = new Uint32Array(bricks.reduce((sum, { geometry }) => sum + geometry.length, 0));
  let end = 0;
  for (const { geometry } of bricks) {
    words.set(geometry, end);
    end += geometry.length;
  }
  const { geometryPrecision: precision } = bricks[0].level === 0 ? STREAM_PRECISION : BLOB_PRECISION;
  const span = { first: 0, count: CHUNK_SPLATS * cells.length, chunks: chunksWithoutBounds(cells) };
  return { count: span.count, precision, words, spans: () => [span] };
}

/** Whether a view would draw the brick now. */
function isNeeded({ value }: ValuedBrick): boolean {
  return value > DRAWN;
}

/**
 * `best` with the bricks of `others` adjacent to it in the file, in file order, as far as one
 * request may go.
 */
function runAround(
  best: LackingBrick,
  others: readonly LackingBrick[],
  mostBricks: number,
  mostBytes: number,
): readonly LackingBrick[] {
  const starting = new Map(others.map((each) => [addressOf(each).offset, each]));
  const ending = new Map(others.map((each) => [endOf(each), each]));
  const run = [best];
  let bytes = addressOf(best).bytes;
  for (;;) {
    const next = starting.get(endOf(run.at(-1)!)) ?? ending.get(addressOf(run[0]).offset);
    bytes += next ? addressOf(next).bytes : 0;
    if (!next || run.length === mostBricks || bytes > mostBytes) return run;
    if (addressOf(next).offset > addressOf(best).offset) run.push(next);
    else run.unshift(next);
  }
}

function valued(demand: BrickPlan, above: PlacedCell): ValuedBrick {
  return { value: demand.valueOf(above), number: above.child!.number };
}

function addressOf({ above }: LackingBrick): BrickAddress {
  return above.child!;
}

function endOf(brick: LackingBrick): number {
  const { offset, bytes } = addressOf(brick);
  return offset + bytes;
}

function isPlaced(cell: PlacedCell): boolean {
  const { above } = cell.brick;
  return !above || (above.below === cell.brick && isPlaced(above));
}
