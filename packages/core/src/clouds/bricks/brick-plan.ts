import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import {
  type CloudSight,
  LEAST_SQUARED,
  OUT_OF_SIGHT,
  reachesIn,
  squaredThreshold,
} from '../stream/cloud-sight.ts';
import type { PlacedBrick, PlacedCell } from './brick-pool.ts';

/** A brick with its value for the views: see `BrickPlan`. */
export interface ValuedBrick {
  readonly number: number;
  readonly value: number;
}

/** A brick that is not on the GPU, below a cell that is. */
export interface LackingBrick extends ValuedBrick {
  readonly above: PlacedCell;
}

/** A brick on the GPU other than the root. */
export interface ResidentBrick extends ValuedBrick {
  readonly brick: PlacedBrick;
}

/** Least squared shift; the shift of any budget is larger. */
const LEAST_SHIFT = 1e-80;
/** Bricks of a larger value would be drawn now. */
export const DRAWN = 1;
/**
 * Divides logarithms of values, so that every brick that is only predicted ranks below every drawn
 * brick.
 */
const PREDICTED_SCALE = 1024;
const DRAWN_SOON = Math.log1p(DRAWN) / PREDICTED_SCALE;

/**
 * Ranks the bricks of a scene by value. The value is the squared ratio of two errors: the error
 * that the brick removes, and the error that the most demanding view allows. Bricks above `DRAWN`
 * would be drawn now; bricks above `DRAWN_SOON` would be drawn if moving views go on as predicted.
 */
export class BrickPlan {
  readonly #sights: readonly CloudSight[];
  readonly #predicted: readonly CloudSight[];
  /** Cached, because each brick that arrives asks for the values of most cells. */
  readonly #values = new Map<PlacedCell, number>();

  /** @param predicted sights of moving views, extrapolated. */
  constructor(sights: readonly CloudSight[], predicted: readonly CloudSight[] = []) {
    this.#sights = sights;
    this.#predicted = predicted;
  }

  isFor(sights: readonly CloudSight[], predicted: readonly CloudSight[]): boolean {
    return sights === this.#sights && predicted === this.#predicted;
  }

  /** The value of the brick below a cell. */
  valueOf(cell: PlacedCell): number {
    let value = this.#values.get(cell);
    if (value === undefined) {
      value = this.#find(cell);
      this.#values.set(cell, value);
    }
    return value;
  }

  #find(cell: PlacedCell): number {
    const value = mostExceeded(cell, this.#sights);
    if (value > DRAWN || this.#predicted.length === 0) return value;
    return Math.log1p(Math.max(value, mostExceeded(cell, this.#predicted))) / PREDICTED_SCALE;
  }

  /**
   * Bricks that would be drawn but are not on the GPU, the most valuable first.
   *
   * @param isAhead whether to include bricks that would be drawn soon.
   */
  lacking(root: PlacedBrick, isAhead = false): LackingBrick[] {
    const least = isAhead && this.#predicted.length > 0 ? DRAWN_SOON : DRAWN;
    const lacking: LackingBrick[] = [];
    const visit = ({ level, cells }: PlacedBrick) => {
      // Most bricks are of the lowest level, which has none below.
      if (level === 0) return;
      for (const cell of cells) {
        const value = this.valueOf(cell);
        if (value <= least) continue;
        if (cell.below) visit(cell.below);
        else lacking.push({ above: cell, value, number: cell.child!.number });
      }
    };
    visit(root);
    return lacking.sort((a, b) => (isWorthMore(a, b) ? -1 : 1));
  }

  /** Bricks without the root, the least valuable first. */
  ranked(bricks: readonly PlacedBrick[]): ResidentBrick[] {
    const ranked = bricks.flatMap((brick) =>
      brick.above ? [{ brick, value: this.valueOf(brick.above), number: brick.address.number }] : [],
    );
    return ranked.sort((a, b) => (isWorthMore(a, b) ? 1 : -1));
  }
}

/**
 * Whether brick `a` gets room before brick `b`. No two bricks tie, so the views alone decide which
 * bricks are resident. A brick never ranks above its parent: it is no nearer to any view, and its
 * error is no larger.
 */
export function isWorthMore(a: ValuedBrick, b: ValuedBrick): boolean {
  return a.value > b.value || (a.value === b.value && a.number < b.number);
}

/** The largest squared ratio, over all sights, of a cell's child error to the allowed error. */
function mostExceeded(
  { bounds, largestScale, childErrors }: PlacedCell,
  sights: readonly CloudSight[],
): number {
  const error = squaredError(Math.max(...childErrors));
  let most = 0;
  for (const { cut, squaredShift, sides } of sights) {
    const ratio = error / Math.max(LEAST_SQUARED, squaredThreshold(bounds, cut));
    const isInSight = sides.every((side) => reachesIn(side, bounds, largestScale));
    // Without an allowed error, bricks are ordered by their errors in pixels.
    const value = isInSight
      ? ratio / Math.max(LEAST_SHIFT, squaredShift ?? 1)
      : Math.min(1, OUT_OF_SIGHT * ratio);
    most = Math.max(most, value);
  }
  return most;
}

const bits = new DataView(new ArrayBuffer(4));

/** The squared threshold that an error in a link encodes. */
function squaredError(error: number): number {
  bits.setUint32(0, error << LEVEL_CONSTANTS.ERROR_SHIFT);
  return bits.getFloat32(0);
}
