import type { Brick, BrickScene } from '../../data/bricks/brick.ts';
import type { SplatCloud } from '../splat-cloud.ts';
import { BrickDemand, type BrickSight, type LackingBrick } from './brick-demand.ts';
import type { BrickPool, PlacedBrick, PlacedCell } from './brick-pool.ts';

/** Bricks that are fetched at once. */
const FETCHED_AT_ONCE = 4;
/** A brick takes another's place where it is worth so much more: else two would take turns. */
const WORTH_MORE = 2;

/** What is there of a scene. */
export interface StreamReport {
  readonly brickCount: number;
  /** Bricks on the GPU, and those that it has room for. */
  readonly residentBricks: number;
  readonly capacityBricks: number;
  /** Bricks that views would draw, as far as is known, and that are not there. */
  readonly missingBricks: number;
  /** Of these, those for which there is no room. */
  readonly refusedBricks: number;
  /** Bricks being fetched, and bytes of those that were. */
  readonly fetching: number;
  readonly fetchedBytes: number;
  /** Why the last fetch failed; null where none has since. Missing bricks are not asked for then. */
  readonly error: Error | null;
}

interface Fetch {
  readonly above: PlacedCell;
  readonly ending: AbortController;
}

/**
 * Keeps those bricks of a scene on the GPU that views need most. Parents come before children, and
 * children go before parents, so that each part is always drawn, only coarser while it is missing.
 */
export class BrickStream {
  readonly #scene: BrickScene;
  readonly #pool: BrickPool;
  readonly #root: PlacedBrick;
  readonly #sights = new Map<object, { readonly sight: BrickSight; readonly redraw: () => void }>();
  /** By number of the brick. */
  readonly #fetches = new Map<number, Fetch>();
  #missing: readonly LackingBrick[] = [];
  #refused = 0;
  #fetchedBytes: number;
  #error: Error | null = null;
  #isEnded = false;
  /** Settles when nothing is missing that could be there; null if it is so. */
  #wait: { readonly complete: Promise<void>; readonly end: () => void } | null = null;

  /**
   * @param pool with the root of `scene`.
   * @param root that brick.
   */
  constructor(scene: BrickScene, pool: BrickPool, root: PlacedBrick) {
    this.#scene = scene;
    this.#pool = pool;
    this.#root = root;
    this.#fetchedBytes = scene.root.bytes;
  }

  /** Says how a view sees the scene. `redraw` is called when its picture changes. */
  see(view: object, sight: BrickSight, redraw: () => void): void {
    this.#sights.set(view, { sight, redraw });
    this.#follow();
  }

  /** The view shows the scene no longer. */
  leave(view: object): void {
    if (this.#sights.delete(view)) this.#follow();
  }

  /** Fetches again what could not be. */
  retry(): void {
    this.#error = null;
    this.#follow();
  }

  /** Settles when nothing is missing any more that there is room for; null if it is so. */
  get complete(): Promise<void> | null {
    return this.#wait?.complete ?? null;
  }

  report(): StreamReport {
    const { lowest, upper } = this.#pool.slots;
    return {
      brickCount: this.#scene.brickCount,
      residentBricks: this.#pool.bricks.length,
      capacityBricks: lowest + upper,
      missingBricks: this.#missing.length,
      refusedBricks: this.#refused,
      fetching: this.#fetches.size,
      fetchedBytes: this.#fetchedBytes,
      error: this.#error,
    };
  }

  /** Ends all fetches. */
  end(): void {
    this.#isEnded = true;
    for (const { ending } of this.#fetches.values()) ending.abort();
    this.#settle();
  }

  get #demand(): BrickDemand {
    return new BrickDemand([...this.#sights.values()].map(({ sight }) => sight));
  }

  /** Fetches what views lack, and ends fetches of what none wants any more. */
  #follow(): void {
    if (this.#isEnded) return;
    const demand = this.#demand;
    this.#missing = demand.lacking(this.#root);
    const wanted = new Set(this.#missing.map(({ above }) => above.child!.number));
    for (const [number, { ending }] of this.#fetches) if (!wanted.has(number)) ending.abort();
    const waiting = this.#missing.filter(({ above }) => !this.#fetches.has(above.child!.number));
    const possible = waiting.filter((each) => this.#hasPlaceFor(demand, each));
    this.#refused = waiting.length - possible.length;
    if (!this.#error)
      for (const { above } of possible.slice(0, FETCHED_AT_ONCE - this.#fetches.size))
        void this.#fetch(above);
    if (this.#fetches.size === 0) this.#settle();
    else if (!this.#wait) {
      let end = () => {};
      const complete = new Promise<void>((resolve) => {
        end = resolve;
      });
      this.#wait = { complete, end };
    }
  }

  #settle(): void {
    this.#wait?.end();
    this.#wait = null;
  }

  #hasPlaceFor(demand: BrickDemand, { above, value }: LackingBrick): boolean {
    const level = above.brick.level - 1;
    return this.#pool.hasRoom(level) || this.#victim(demand, level, above, value) !== null;
  }

  /** A brick of the same kind that is worth less; null if there is none. */
  #victim(demand: BrickDemand, level: number, above: PlacedCell, value: number): PlacedBrick | null {
    const bricks = this.#pool.bricks.filter(
      (brick) => (brick.level === 0) === (level === 0) && brick !== above.brick,
    );
    const least = demand.leastValuable(bricks);
    return least && WORTH_MORE * least.value < value ? least.brick : null;
  }

  async #fetch(above: PlacedCell): Promise<void> {
    const address = above.child!;
    const ending = new AbortController();
    this.#fetches.set(address.number, { above, ending });
    try {
      const brick = await this.#scene.read(address, ending.signal);
      this.#fetchedBytes += address.bytes;
      if (!this.#isEnded && !ending.signal.aborted) this.#take(brick, above);
    } catch (error) {
      if (!ending.signal.aborted) this.#error = error as Error;
    } finally {
      this.#fetches.delete(address.number);
      this.#follow();
    }
  }

  /** Places a brick that has arrived, if it is still worth its room. */
  #take(brick: Brick, above: PlacedCell): void {
    // Its parent may have gone meanwhile.
    if (!isPlaced(above)) return;
    const demand = this.#demand;
    const value = demand.valueOf(above);
    if (!this.#pool.hasRoom(brick.level)) {
      const victim = this.#victim(demand, brick.level, above, value);
      if (!victim) return;
      this.#pool.remove(victim);
    }
    this.#pool.place(brick, above.child!, above);
    for (const { redraw } of this.#sights.values()) redraw();
  }
}

function isPlaced(cell: PlacedCell): boolean {
  const { above } = cell.brick;
  return !above || (above.below === cell.brick && isPlaced(above));
}

/** A scene that streams, with the cloud that shows it. */
export interface StreamedScene {
  readonly cloud: SplatCloud;
  readonly stream: BrickStream;
}
