import type { FrustumSide } from '../../data/camera/frustum.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { Bounds } from '../../data/packing/packed-cloud.ts';
import type { CloudSight } from '../cloud-stream.ts';
import type { PlacedBrick, PlacedCell } from './brick-pool.ts';

/** A brick that views would draw, with its value: see `BrickDemand`. */
export interface ValuedBrick {
  readonly number: number;
  readonly value: number;
}

/** A brick that is not on the GPU, below a cell that is. */
export interface LackingBrick extends ValuedBrick {
  readonly above: PlacedCell;
}

/** A brick that is, other than the root. */
export interface ResidentBrick extends ValuedBrick {
  readonly brick: PlacedBrick;
}

/** Bricks out of sight count as this much less: they are kept only where nothing else needs room. */
export const OUT_OF_SIGHT = 1e-12;
/** Least squared threshold, so that errors can be divided by it. */
export const LEAST_SQUARED = 1e-36;
/** Least squared shift: whatever a budget leads to is more. */
const LEAST_SHIFT = 1e-80;
/** Values of bricks that would be drawn, and of those that would be soon. */
export const DRAWN = 1;
/** Divides logarithms of values, so that none of what is only foreseen is that of a drawn brick. */
const FORESEEN_SCALE = 1024;
const DRAWN_SOON = Math.log1p(DRAWN) / FORESEEN_SCALE;
/** Slack of tests in float32, as in chunk-groups. */
const SLACK = 1e-4;

/**
 * What views want of a scene. The value of a brick is how far the error that it takes away exceeds
 * what the view that needs it most allows, as a ratio of squares: above `DRAWN`, the brick would be
 * drawn. Of the others, those that would be in a view as it is foreseen are worth more than
 * `DRAWN_SOON`, and the rest less.
 */
export class BrickDemand {
  readonly #sights: readonly CloudSight[];
  readonly #foreseen: readonly CloudSight[];
  /** Those that are known: most cells are asked for with each brick that arrives. */
  readonly #values = new Map<PlacedCell, number>();

  /** @param foreseen how views that move will see the scene. */
  constructor(sights: readonly CloudSight[], foreseen: readonly CloudSight[] = []) {
    this.#sights = sights;
    this.#foreseen = foreseen;
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
    if (value > DRAWN || this.#foreseen.length === 0) return value;
    return Math.log1p(Math.max(value, mostExceeded(cell, this.#foreseen))) / FORESEEN_SCALE;
  }

  /**
   * Bricks that would be drawn if they were there, the most valuable first.
   *
   * @param isAhead whether also those that would be drawn soon.
   */
  lacking(root: PlacedBrick, isAhead = false): LackingBrick[] {
    const least = isAhead && this.#foreseen.length > 0 ? DRAWN_SOON : DRAWN;
    const lacking: LackingBrick[] = [];
    const visit = (cell: PlacedCell) => {
      if (!cell.child) return;
      const value = this.valueOf(cell);
      if (value <= least) return;
      if (cell.below) for (const each of cell.below.cells) visit(each);
      else lacking.push({ above: cell, value, number: cell.child.number });
    };
    for (const cell of root.cells) visit(cell);
    return lacking.sort((a, b) => (isWorthMore(a, b) ? -1 : 1));
  }

  /** Bricks other than the root, the least valuable first. */
  ranked(bricks: readonly PlacedBrick[]): ResidentBrick[] {
    const ranked = bricks.flatMap((brick) =>
      brick.above ? [{ brick, value: this.valueOf(brick.above), number: brick.address.number }] : [],
    );
    return ranked.sort((a, b) => (isWorthMore(a, b) ? 1 : -1));
  }
}

/**
 * Whether one brick is to have room rather than another. No two are worth the same, so that what is
 * there follows from the views alone. A brick is worth no more than its parent: what is below a cell
 * is nearer to no view than the cell, and its error no larger.
 */
export function isWorthMore(a: ValuedBrick, b: ValuedBrick): boolean {
  return a.value > b.value || (a.value === b.value && a.number < b.number);
}

/** How far the error of a cell's brick exceeds what the view that needs it most allows. */
function mostExceeded(
  { bounds, largestScale, childErrors }: PlacedCell,
  sights: readonly CloudSight[],
): number {
  const error = squaredError(Math.max(...childErrors));
  let most = 0;
  for (const { cut, squaredShift, sides } of sights) {
    const ratio = error / Math.max(LEAST_SQUARED, squaredThreshold(bounds, cut));
    const isSeen = sides.every((side) => reachesIn(side, bounds, largestScale));
    // Without an allowed error, too, the order is that of errors in pixels.
    const value = isSeen ? ratio / Math.max(LEAST_SHIFT, squaredShift) : Math.min(1, OUT_OF_SIGHT * ratio);
    most = Math.max(most, value);
  }
  return most;
}

const bits = new DataView(new ArrayBuffer(4));

/** The square that an error in a link stands for: the least at which it is not seen. */
function squaredError(error: number): number {
  bits.setUint32(0, error << LEVEL_CONSTANTS.ERROR_SHIFT);
  return bits.getFloat32(0);
}

/** As cut-cells finds it. */
export function squaredThreshold(
  { min, max }: Bounds,
  { camera, squaredPerDistance, leastSquared, margin }: CloudSight['cut'],
): number {
  let distance2 = 0;
  for (let axis = 0; axis < 3; axis++) {
    const apart = Math.max(min[axis] - camera[axis], camera[axis] - max[axis]) - margin;
    if (apart > 0) distance2 += apart * apart;
  }
  return Math.max(distance2 * squaredPerDistance, leastSquared);
}

/** Whether splats in these bounds may reach past a side of the frustum into it. */
export function reachesIn(
  { normal, offset, reach }: FrustumSide,
  { min, max }: Bounds,
  largestScale: number,
): boolean {
  let nearest = offset + reach * largestScale;
  let size = Math.abs(nearest);
  for (let axis = 0; axis < 3; axis++) {
    const part = normal[axis] * (normal[axis] > 0 ? max[axis] : min[axis]);
    nearest += part;
    size += Math.abs(part);
  }
  return nearest >= -SLACK * size;
}
