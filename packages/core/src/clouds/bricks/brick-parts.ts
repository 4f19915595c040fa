import type { Brick, BrickAddress, BrickScene } from '../../data/bricks/brick.ts';
import { MOST_REQUEST_BYTES } from '../../data/bricks/brick-files.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { BLOB_PRECISION } from '../../data/packing/precision.ts';
import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import { chunksWithoutBounds, STREAM_PRECISION } from '../stream/chunk-pages.ts';
import type { CloudSight } from '../stream/cloud-sight.ts';
import type { CoarseSplats } from '../stream/cloud-stream.ts';
import { streamInto } from '../stream/scene-pool.ts';
import type { MissingPart, PartEvents, SceneParts } from '../stream/scene-stream.ts';
import type { PartLimit, Sights } from '../stream/scene-viewers.ts';
import { checkBudget, type StreamContext, type StreamOptions } from '../stream/stream-budget.ts';
import {
  BrickPlan,
  DRAWN,
  isWorthMore,
  type LackingBrick,
  type ResidentBrick,
  type ValuedBrick,
} from './brick-plan.ts';
import {
  BrickPool,
  type PlacedBrick,
  type PlacedCell,
  poolBytes,
  roomFor,
  rootStages,
  slotsFor,
} from './brick-pool.ts';

export { FIRST_STAGES } from '../stream/chunk-pages.ts';

/** Most bytes of bricks, the root included, that are requested before the first picture. */
const MOST_BYTES_AT_FIRST = 3 << 19;

interface MissingBrick extends LackingBrick, MissingPart {}

/** A fetched brick that waits to be placed. */
interface ArrivedBrick {
  readonly brick: Brick;
  readonly above: PlacedCell;
  /** Aborted if no view wants the brick any more. */
  readonly signal: AbortSignal;
}

/**
 * The bricks of a scene. Parents are placed before children, and children removed before parents.
 * So every part of the scene is always drawn, coarser while bricks are missing.
 */
export class BrickParts implements SceneParts<MissingBrick> {
  readonly needsShift = true;
  readonly isHolding = false;
  readonly #scene: BrickScene;
  #pool: BrickPool;
  readonly #root: PlacedBrick;
  #plan = new BrickPlan([]);
  /** Result of the last plan; null once views or the bricks on the GPU have changed. */
  #lacking: readonly MissingBrick[] | null = null;
  /** Bricks that views would draw now. */
  #needed: readonly MissingBrick[] = [];
  /** Whether there is a free slot for each brick of `#lacking`. */
  #haveSlots = false;
  /** By brick number. */
  readonly #arrived = new Map<number, ArrivedBrick>();
  /** Time that the last merge took on the thread. */
  #mergeMs = 0;
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
    this.#scene = scene;
    this.#pool = pool;
    this.#root = root;
    this.#fetchedBytes = scene.root.bytes;
    this.#requestedBytes = scene.root.bytes;
    // The shaders compile early. If they fail, placing the first brick reports it.
    pool.ready(0).catch(() => {});
  }

  plan(sights: Sights): readonly MissingBrick[] {
    this.#replan(sights);
    // A brick is missing until it is placed, so the list stays valid while others are fetched.
    this.#lacking ??= this.#findMissing();
    if (sights.areCurrent && this.#lacking.length === 0) this.#reads.clear();
    return this.#lacking;
  }

  #findMissing(): readonly MissingBrick[] {
    const lacking = this.#plan.lacking(this.#root, true);
    const fits = this.#fitting();
    const missing = lacking.map((each) => {
      const { above, number, value } = each;
      return { above, number, value, isNeeded: value > DRAWN, fits: fits(each) };
    });
    const lowest = lacking.filter(({ above }) => above.brick.level === 1).length;
    const upper = lacking.length - lowest;
    this.#haveSlots = lowest <= this.#pool.freeSlots(0) && upper <= this.#pool.freeSlots(1);
    this.#needed = missing.filter(({ isNeeded }) => isNeeded);
    return missing;
  }

  /** Takes placed bricks out of the missing ones: the same as to find all again, in less time. */
  #dropPlaced(): void {
    if (!this.#lacking) return;
    const isMissing = ({ above }: MissingBrick) => !above.below;
    this.#lacking = this.#lacking.filter(isMissing);
    this.#needed = this.#needed.filter(isMissing);
  }

  #replan({ sights, predicted }: Sights): void {
    if (this.#plan.isFor(sights, predicted)) return;
    this.#plan = new BrickPlan(sights, predicted);
    this.#lacking = null;
  }

  /**
   * Tells whether missing bricks, asked for from the most valuable one on, fit: into free slots, or
   * into slots of less valuable bricks.
   */
  #fitting(): (brick: LackingBrick) => boolean {
    const kinds = [0, 1].map((level) => ({
      level,
      taken: 0,
      free: this.#pool.freeSlots(level),
      // Ranking is expensive, and needed only if no slot is free.
      others: null as readonly ResidentBrick[] | null,
    }));
    return (brick) => {
      const kind = kinds[brick.above.brick.level === 1 ? 0 : 1];
      const place = kind.taken++ - kind.free;
      if (place < 0) return true;
      kind.others ??= this.#ranked(kind.level);
      return place < kind.others.length && isWorthMore(brick, kind.others[place]);
    };
  }

  /**
   * A brick with adjacent missing ones. Before the first picture, requests stay small: further bytes
   * would delay it on slow networks.
   */
  requestWith(
    first: MissingBrick,
    partAt: (number: number) => MissingBrick | null,
    mostBricks: number,
    isPictured: boolean,
  ): readonly MissingBrick[] {
    const bytesLeft = isPictured
      ? MOST_REQUEST_BYTES
      : Math.min(MOST_REQUEST_BYTES, MOST_BYTES_AT_FIRST - this.#requestedBytes);
    if (addressOf(first).bytes > bytesLeft && !isPictured) return [];
    const run = runAround(first, partAt, mostBricks, bytesLeft);
    this.#requestedBytes += bytesOf(run.map(addressOf));
    return run;
  }

  async fetch({ above, number }: MissingBrick, signal: AbortSignal, events: PartEvents): Promise<void> {
    const brick = await this.#read(above.child!, signal, events);
    await this.#pool.ready(brick.level);
    this.#arrived.set(number, { brick, above, signal });
    this.#reads.delete(number);
  }

  /** Reads a brick once, shared by concurrent callers. */
  async #read(address: BrickAddress, signal: AbortSignal | undefined, events: PartEvents): Promise<Brick> {
    const { number, bytes } = address;
    const other = this.#reads.get(number);
    if (other) {
      // The read may fail only because the other caller aborts it. Other errors meet this caller's own read.
      const brick = await other.catch(() => null);
      if (brick) return brick;
      signal?.throwIfAborted();
    }
    const reading = this.#scene.read(address, signal);
    this.#reads.set(number, reading);
    try {
      const brick = await reading;
      this.#fetchedBytes += bytes;
      events.onBytes(bytes);
      return brick;
    } catch (error) {
      if (this.#reads.get(number) === reading) this.#reads.delete(number);
      throw error;
    }
  }

  get isWaiting(): boolean {
    return this.#arrived.size > 0;
  }

  upload({ parts: mostBricks, ms }: PartLimit, events: PartEvents): number {
    const endMs = performance.now() + ms - this.#mergeMs;
    const worth = ({ above }: ArrivedBrick) => valued(this.#plan, above);
    const arrived = [...this.#arrived].toSorted(([, a], [, b]) => (isWorthMore(worth(a), worth(b)) ? -1 : 1));
    let placed = 0;
    for (const [number, { brick, above, signal }] of arrived) {
      this.#arrived.delete(number);
      events.onSettled(number);
      if (signal.aborted) continue;
      try {
        placed += Number(this.#place(brick, above));
      } catch (error) {
        events.onError(error as Error);
      }
      if (placed >= mostBricks || performance.now() >= endMs) break;
    }
    if (placed > 0) this.#dropPlaced();
    const beginMs = performance.now();
    try {
      this.#pool.merge();
    } catch (error) {
      events.onError(error as Error);
    }
    this.#mergeMs = performance.now() - beginMs;
    return placed;
  }

  /** Places a fetched brick if it is still worth its room; returns whether it was placed. */
  #place(brick: Brick, above: PlacedCell): boolean {
    // The parent may have been removed since the fetch began.
    if (!isPlaced(above)) return false;
    const isFull = this.#pool.freeSlots(brick.level) === 0;
    const least = isFull ? this.#ranked(brick.level)[0] : null;
    if (isFull && !(least && isWorthMore(valued(this.#plan, above), least))) return false;
    this.#pool.place(brick, above.child!, above, least?.brick);
    // The bricks below it are missing now, or others have less room.
    if (brick.level > 0 || !this.#haveSlots) this.#lacking = null;
    return true;
  }

  /**
   * Resident bricks that use the same kind of slot as `level`, without the root, the least valuable
   * first.
   */
  #ranked(level: number): readonly ResidentBrick[] {
    return this.#plan.ranked(this.#pool.bricks.filter((brick) => (brick.level === 0) === (level === 0)));
  }

  resize(bytes: number, sights: Sights): void {
    this.#replan(sights);
    const slots = slotsFor(this.#scene, bytes);
    for (const isLowest of [true, false]) {
      const placed = () => this.#pool.bricks.filter(({ level }) => (level === 0) === isLowest);
      const most = isLowest ? slots.lowest : slots.upper;
      // The least valuable first, so that children go before their parents.
      const ranked = this.#plan.ranked(placed());
      for (const { brick } of ranked.slice(0, Math.max(0, placed().length - most))) this.#pool.remove(brick);
    }
    this.#pool = this.#pool.resized(slots);
    this.#lacking = null;
  }

  whenDone(): Promise<unknown> {
    return this.#pool.whenDone();
  }

  end(): void {
    this.#scene.end();
  }

  report(): ReturnType<SceneParts<MissingBrick>['report']> {
    const { lowest, upper } = this.#pool.slots;
    const mostBricks = lowest + upper;
    const refused = this.#needed.filter(({ fits }) => !fits).length;
    return {
      bricks: this.#scene.brickCount,
      residentBricks: mostBricks - this.#pool.freeSlots(0) - this.#pool.freeSlots(1),
      mostBricks,
      missingBricks: this.#needed.length,
      refusedBricks: refused,
      fetchedBytes: this.#fetchedBytes,
      keptBytes: 0,
      isComplete: this.#needed.length === refused,
    };
  }

  missingFor(sights: readonly CloudSight[]): number {
    return new BrickPlan(sights).lacking(this.#root).length;
  }

  lackingCells(): Set<number> {
    return new Set(this.#needed.map(({ above }) => above.cell));
  }

  /**
   * Leaves of the finest level whose bricks take at most MOST_BYTES_AT_FIRST bytes; independent of
   * the views.
   */
  async coarse(signal: AbortSignal | undefined, events: PartEvents): Promise<CoarseSplats> {
    this.#coarse ??= coarseSplats(await this.#coarseBricks(signal, events));
    return this.#coarse;
  }

  async #coarseBricks(signal: AbortSignal | undefined, events: PartEvents): Promise<readonly Brick[]> {
    let bricks: readonly Brick[] = [];
    let below = addressesBelow(this.#root);
    // The root alone, 256 blobs, is too coarse.
    while (below.length > 0 && (bricks.length === 0 || bytesOf(below) <= MOST_BYTES_AT_FIRST)) {
      bricks = await Promise.all(below.map((address) => this.#read(address, signal, events)));
      below = bricks.flatMap(addressesBelow);
    }
    return bricks.length > 0 ? bricks : [await this.#scene.read(this.#scene.root, signal)];
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

/**
 * `best` with the bricks that may be fetched and adjoin it in the file, in file order, as far as one
 * request may go. Files have bricks in the order of their numbers.
 */
function runAround(
  best: MissingBrick,
  partAt: (number: number) => MissingBrick | null,
  mostBricks: number,
  mostBytes: number,
): readonly MissingBrick[] {
  const run = [best];
  let bytes = addressOf(best).bytes;
  const adjoining = () => {
    const [first, last] = [run[0], run.at(-1)!];
    const after = partAt(last.number + 1);
    if (after && addressOf(after).offset === endOf(last)) return after;
    const before = partAt(first.number - 1);
    return before && endOf(before) === addressOf(first).offset ? before : null;
  };
  for (let next = adjoining(); next; next = adjoining()) {
    bytes += addressOf(next).bytes;
    if (run.length === mostBricks || bytes > mostBytes) break;
    if (next.number > best.number) run.push(next);
    else run.unshift(next);
  }
  return run;
}

function valued(plan: BrickPlan, above: PlacedCell): ValuedBrick {
  return { value: plan.valueOf(above), number: above.child!.number };
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

/**
 * Makes a cloud that streams the parts of a scene that views need. Resolves when the coarsest part
 * is on the GPU.
 *
 * @throws InvalidArgumentError if the budget does not hold a brick of each level; GpuLimitError if
 *   the device lacks memory; errors of `scene.read`. Nothing is left allocated then.
 */
export async function streamBricks(
  context: StreamContext,
  scene: BrickScene,
  options: StreamOptions,
  { onDestroyed }: Pick<SplatCloudOptions, 'onDestroyed'>,
): Promise<SplatCloud> {
  const { name, shDegree } = scene;
  const { least, most } = roomFor(scene);
  const need = { name, leastBytes: poolBytes(shDegree, least), mostBytes: poolBytes(shDegree, most) };
  checkBudget(need, options);
  // Starts compiling the pipelines early. Making the pool throws the same error if that fails.
  context.pipelines.prepare(rootStages(scene)).catch(() => {});
  const brick = await scene.read(scene.root, options.signal);
  const makePool = (bytes: number) => BrickPool.make(context, scene, slotsFor(scene, bytes));
  const begin = (pool: BrickPool) => {
    const root = pool.place(brick, scene.root, null);
    pool.merge();
    return new BrickParts(scene, pool, root);
  };
  return streamInto(context, need, { ...options, onDestroyed }, makePool, begin);
}
