import type { Brick, BrickAddress, BrickScene } from '../../data/bricks/brick.ts';
import { MOST_REQUEST_BYTES } from '../../data/bricks/brick-files.ts';
import { SplatSourceError } from '../../data/errors.ts';
import type { CloudSight, CloudStream, StreamReport } from '../cloud-stream.ts';
import { BrickDemand, isWorthMore, type LackingBrick } from './brick-demand.ts';
import type { BrickPool, PlacedBrick, PlacedCell } from './brick-pool.ts';

/** Runs of bricks that are fetched at once. */
const FETCHED_AT_ONCE = 4;
/** Bricks that may wait in memory, a few hundred kilobytes each, while what is there must not change. */
const MOST_ARRIVED = 32;
/** Time over which bytes per second are counted. */
const RATE_WINDOW_MS = 2000;

interface Fetch {
  readonly above: PlacedCell;
  /** Bricks that lie next to each other and are fetched together. */
  readonly run: readonly LackingBrick[];
  readonly ending: AbortController;
  /** Null until it has arrived. */
  brick: Brick | null;
}

interface Viewer {
  readonly sights: readonly CloudSight[];
  /** Whether these are of its last frame. */
  readonly isCurrent: boolean;
  readonly redraw: () => Promise<unknown>;
}

/**
 * Keeps those bricks of a scene on the GPU that views need most. Parents come before children, and
 * children go before parents, so that each part is always drawn, only coarser while it is missing.
 */
export class BrickStream implements CloudStream {
  readonly #scene: BrickScene;
  readonly #pool: BrickPool;
  readonly #root: PlacedBrick;
  readonly #viewers = new Map<object, Viewer>();
  readonly #listeners = new Set<() => void>();
  /** What the viewers want; null until it is asked for. */
  #known: BrickDemand | null = null;
  /** Views that are drawing what has changed, and those that are to draw it once more. */
  readonly #drawing = new Set<object>();
  readonly #stale = new Set<object>();
  /** By number of the brick, until it is placed. */
  readonly #fetches = new Map<number, Fetch>();
  /** What is there must not change until these settle. */
  readonly #holds = new Set<Promise<unknown>>();
  #missing: readonly LackingBrick[] = [];
  #refused = 0;
  #fetchedBytes: number;
  /** Bricks of the last seconds, oldest first. */
  #arrivals: readonly { readonly atMs: number; readonly bytes: number }[] = [];
  /** When fetching began, after nothing was being fetched. */
  #busySinceMs = 0;
  #error: Error | null = null;
  #isEnded = false;
  readonly #onOnline = () => {
    if (this.#error instanceof SplatSourceError) this.retry();
  };
  /** Settles when nothing is missing that could be there; null if it is so. */
  #wait: { readonly complete: Promise<void>; readonly end: () => void } | null = null;

  /** @param root the root of `scene`, in `pool`. */
  constructor(scene: BrickScene, pool: BrickPool, root: PlacedBrick) {
    this.#scene = scene;
    this.#pool = pool;
    this.#root = root;
    this.#fetchedBytes = scene.root.bytes;
    // Pages and workers are told; elsewhere there is no such event.
    globalThis.addEventListener?.('online', this.#onOnline);
  }

  get complete(): Promise<void> | null {
    return this.#wait?.complete ?? null;
  }

  see(view: object, sights: readonly CloudSight[] | null, redraw: () => Promise<unknown>): void {
    const before = this.#viewers.get(view)?.sights ?? [];
    this.#viewers.set(view, { sights: sights ?? before, isCurrent: sights !== null, redraw });
    this.#known = null;
    this.#follow();
  }

  subscribe(listener: () => void): () => void {
    // Each call has an entry of its own.
    const entry = () => listener();
    this.#listeners.add(entry);
    return () => this.#listeners.delete(entry);
  }

  leave(view: object): void {
    this.#stale.delete(view);
    if (!this.#viewers.delete(view)) return;
    this.#known = null;
    this.#follow();
  }

  hold(until: Promise<unknown>): void {
    this.#holds.add(until);
    const release = () => {
      this.#holds.delete(until);
      this.#placeArrived();
    };
    until.then(release, release);
  }

  retry(): void {
    this.#error = null;
    this.#follow();
  }

  report(): StreamReport {
    const { lowest, upper } = this.#pool.slots;
    return {
      bricks: this.#scene.brickCount,
      residentBricks: this.#pool.bricks.length,
      mostBricks: lowest + upper,
      missingBricks: this.#missing.length,
      refusedBricks: this.#refused,
      fetching: this.#fetches.size,
      fetchedBytes: this.#fetchedBytes,
      bytesPerSecond: this.#bytesPerSecond,
      isComplete:
        this.#viewers.size > 0 &&
        [...this.#viewers.values()].every(({ isCurrent }) => isCurrent) &&
        this.#missing.length === this.#refused,
      error: this.#error,
    };
  }

  end(): void {
    this.#isEnded = true;
    globalThis.removeEventListener?.('online', this.#onOnline);
    for (const { ending } of this.#fetches.values()) ending.abort();
    this.#scene.end();
    this.#viewers.clear();
    this.#settle();
    this.#tell();
    this.#listeners.clear();
  }

  get #bytesPerSecond(): number {
    if (this.#fetches.size === 0) return 0;
    const nowMs = performance.now();
    const sinceMs = Math.max(this.#busySinceMs, nowMs - RATE_WINDOW_MS);
    const bytes = this.#arrivals.reduce((sum, each) => sum + (each.atMs >= sinceMs ? each.bytes : 0), 0);
    return nowMs > sinceMs ? (1000 * bytes) / (nowMs - sinceMs) : 0;
  }

  #tell(): void {
    for (const listener of [...this.#listeners]) listener();
  }

  get #demand(): BrickDemand {
    this.#known ??= new BrickDemand([...this.#viewers.values()].flatMap(({ sights }) => sights));
    return this.#known;
  }

  /** Fetches what views lack, and ends fetches of what none of them wants any more. */
  #follow(): void {
    if (this.#isEnded) return;
    const demand = this.#demand;
    this.#missing = demand.lacking(this.#root);
    const wanted = new Set(this.#missing.map(({ above }) => above.child!.number));
    for (const [number, { ending }] of this.#fetches) if (!wanted.has(number)) ending.abort();
    const possible = this.#fitting(demand);
    this.#refused = this.#missing.length - possible.length;
    if (!this.#error) this.#fetchRuns(possible.filter(({ number }) => !this.#fetches.has(number)));
    if (this.#fetches.size === 0) this.#settle();
    else this.#wait ??= pending();
    this.#tell();
  }

  /** Fetches the most valuable bricks, each with others that are wanted and lie next to it. */
  #fetchRuns(waiting: readonly LackingBrick[]): void {
    const fetching = new Set([...this.#fetches.values()].flatMap(({ run, brick }) => (brick ? [] : [run])));
    for (const best of waiting) {
      const places = MOST_ARRIVED - this.#fetches.size;
      if (fetching.size >= FETCHED_AT_ONCE || places <= 0) return;
      if (this.#fetches.has(best.number)) continue;
      const others = waiting.filter(({ number }) => !this.#fetches.has(number));
      const run = runAround(best, others, places);
      fetching.add(run);
      for (const { above } of run) void this.#fetch(above, run);
    }
  }

  #settle(): void {
    this.#wait?.end();
    this.#wait = null;
  }

  /** Those of the missing bricks that free slots hold, or slots of bricks that are worth less. */
  #fitting(demand: BrickDemand): readonly LackingBrick[] {
    const kinds = [true, false].map((isLowest) => ({
      taken: 0,
      free: this.#pool.freeSlots(isLowest ? 0 : 1),
      others: demand.ranked(this.#pool.bricks.filter(({ level }) => (level === 0) === isLowest)),
    }));
    return this.#missing.filter((each) => {
      const kind = kinds[each.above.brick.level === 1 ? 0 : 1];
      const place = kind.taken++ - kind.free;
      return place < 0 || (place < kind.others.length && isWorthMore(each, kind.others[place]));
    });
  }

  async #fetch(above: PlacedCell, run: readonly LackingBrick[]): Promise<void> {
    const address = above.child!;
    const ending = new AbortController();
    const fetch: Fetch = { above, run, ending, brick: null };
    if (this.#fetches.size === 0) this.#busySinceMs = performance.now();
    this.#fetches.set(address.number, fetch);
    try {
      fetch.brick = await this.#scene.read(address, ending.signal);
      this.#takeArrival(address.bytes);
    } catch (error) {
      this.#fetches.delete(address.number);
      if (!ending.signal.aborted) this.#error = error as Error;
    }
    this.#placeArrived();
  }

  #takeArrival(bytes: number): void {
    const atMs = performance.now();
    this.#fetchedBytes += bytes;
    const recent = this.#arrivals.filter((each) => each.atMs > atMs - RATE_WINDOW_MS);
    this.#arrivals = [...recent, { atMs, bytes }];
  }

  /** Places bricks that have arrived, unless what is there must not change; fetches others. */
  #placeArrived(): void {
    if (this.#isEnded) return;
    if (this.#holds.size === 0) {
      for (const [number, { above, ending, brick }] of this.#fetches) {
        if (!brick) continue;
        this.#fetches.delete(number);
        if (!ending.signal.aborted) this.#take(brick, above);
      }
    }
    this.#follow();
  }

  /** Places a brick that has arrived, if it is still worth its room. */
  #take(brick: Brick, above: PlacedCell): void {
    // Its parent may have gone meanwhile.
    if (!isPlaced(above)) return;
    if (this.#pool.freeSlots(brick.level) === 0) {
      const demand = this.#demand;
      const kind = this.#pool.bricks.filter(({ level }) => (level === 0) === (brick.level === 0));
      const [least] = demand.ranked(kind);
      const own = { value: demand.valueOf(above), number: above.child!.number };
      if (!least || !isWorthMore(own, least)) return;
      this.#pool.remove(least.brick);
    }
    this.#pool.place(brick, above.child!, above);
    for (const view of this.#viewers.keys()) void this.#redraw(view);
  }

  /** Draws a view again; once more after that, if anything has changed meanwhile. */
  async #redraw(view: object): Promise<void> {
    this.#stale.add(view);
    if (this.#drawing.has(view)) return;
    this.#drawing.add(view);
    // The view itself tells what fails.
    while (this.#stale.delete(view))
      await this.#viewers
        .get(view)
        ?.redraw()
        .catch(() => {});
    this.#drawing.delete(view);
  }
}

/** A brick with those of `others` before and behind it that one request fetches, in their order. */
function runAround(
  best: LackingBrick,
  others: readonly LackingBrick[],
  mostBricks: number,
): readonly LackingBrick[] {
  const starting = new Map(others.map((each) => [addressOf(each).offset, each]));
  const ending = new Map(others.map((each) => [endOf(each), each]));
  const run = [best];
  let bytes = addressOf(best).bytes;
  for (;;) {
    const next = starting.get(endOf(run.at(-1)!)) ?? ending.get(addressOf(run[0]).offset);
    bytes += next ? addressOf(next).bytes : 0;
    if (!next || run.length === mostBricks || bytes > MOST_REQUEST_BYTES) return run;
    if (addressOf(next).offset > addressOf(best).offset) run.push(next);
    else run.unshift(next);
  }
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

function pending(): { readonly complete: Promise<void>; readonly end: () => void } {
  let end = () => {};
  const complete = new Promise<void>((resolve) => {
    end = resolve;
  });
  return { complete, end };
}
