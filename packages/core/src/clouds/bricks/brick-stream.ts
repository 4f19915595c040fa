import type { Brick, BrickAddress, BrickScene } from '../../data/bricks/brick.ts';
import { MOST_REQUEST_BYTES } from '../../data/bricks/brick-files.ts';
import type { StreamReport } from '../cloud-stream.ts';
import { ViewedStream } from '../viewed-stream.ts';
import { BrickDemand, isWorthMore, type LackingBrick } from './brick-demand.ts';
import type { BrickPool, PlacedBrick, PlacedCell } from './brick-pool.ts';

/** Runs of bricks that are fetched at once. */
const FETCHED_AT_ONCE = 4;
/** Bricks that may wait in memory, a few hundred kilobytes each, while what is there must not change. */
const MOST_ARRIVED = 32;

interface Fetch {
  readonly above: PlacedCell;
  /** Bricks that lie next to each other and are fetched together. */
  readonly run: readonly LackingBrick[];
  readonly ending: AbortController;
  /** Null until it has arrived. */
  brick: Brick | null;
}

/**
 * Keeps those bricks of a scene on the GPU that views need most. Parents come before children, and
 * children go before parents, so that each part is always drawn, only coarser while it is missing.
 */
export class BrickStream extends ViewedStream {
  readonly #scene: BrickScene;
  readonly #pool: BrickPool;
  readonly #root: PlacedBrick;
  /** What the viewers want; null until it is asked for. */
  #known: BrickDemand | null = null;
  /** By number of the brick, until it is placed. */
  readonly #fetches = new Map<number, Fetch>();
  #missing: readonly LackingBrick[] = [];
  #refused = 0;
  #fetchedBytes: number;

  /** @param root the root of `scene`, in `pool`. */
  constructor(scene: BrickScene, pool: BrickPool, root: PlacedBrick) {
    super();
    this.#scene = scene;
    this.#pool = pool;
    this.#root = root;
    this.#fetchedBytes = scene.root.bytes;
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
      bytesPerSecond: this.#fetches.size > 0 ? this.rate.bytesPerSecond : 0,
      isComplete: this.isSeen && this.#missing.length === this.#refused,
      error: this.error,
    };
  }

  override end(): void {
    for (const { ending } of this.#fetches.values()) ending.abort();
    this.#scene.end();
    super.end();
  }

  protected follow(): void {
    this.#known = null;
    this.#placeArrived();
  }

  get #demand(): BrickDemand {
    this.#known ??= new BrickDemand(this.sights);
    return this.#known;
  }

  /** Fetches what views lack, and ends fetches of what none of them wants any more. */
  #fetchLacking(): void {
    if (this.isEnded) return;
    const demand = this.#demand;
    this.#missing = demand.lacking(this.#root);
    const wanted = new Set(this.#missing.map(({ above }) => above.child!.number));
    for (const [number, { ending }] of this.#fetches) if (!wanted.has(number)) ending.abort();
    const possible = this.#fitting(demand);
    this.#refused = this.#missing.length - possible.length;
    if (!this.error) this.#fetchRuns(possible.filter(({ number }) => !this.#fetches.has(number)));
    this.settle(this.#fetches.size === 0);
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
    if (this.#fetches.size === 0) this.rate.begin();
    this.#fetches.set(address.number, fetch);
    try {
      fetch.brick = await this.#scene.read(address, ending.signal);
      this.#fetchedBytes += address.bytes;
      this.rate.take(address.bytes);
    } catch (error) {
      this.#fetches.delete(address.number);
      if (!ending.signal.aborted) this.error = error as Error;
    }
    this.#placeArrived();
  }

  /** Places bricks that have arrived, unless what is there must not change; fetches others. */
  #placeArrived(): void {
    if (this.isEnded) return;
    if (!this.isHeld) {
      for (const [number, { above, ending, brick }] of this.#fetches) {
        if (!brick) continue;
        this.#fetches.delete(number);
        if (!ending.signal.aborted) this.#take(brick, above);
      }
    }
    this.#fetchLacking();
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
    this.redraw();
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
