/** Children per node: a tree over 23,000 boxes then has five levels, and a ray is tested against 42 boxes on average. */
const ARITY = 8;

/** Nearest box that a ray enters. */
export interface BoxEntry {
  /** Distance at which the ray enters the box, in units of its direction's length; 0 inside a box, Infinity for no box. */
  readonly distance: number;
  /** Number of boxes that the ray was tested against. */
  readonly testedBoxes: number;
}

/**
 * A hierarchy over axis-aligned boxes in the order of a space-filling curve. Each node bounds a run of successive boxes, so
 * the tree stores nothing but boxes.
 */
export class BoxTree {
  /** Min x, y, z and max x, y, z of each box. The first level has the given boxes, the last level a single one. */
  readonly #levels: readonly Float64Array[];

  /** @param boxes six finite numbers each: min x, y, z and max x, y, z. */
  constructor(boxes: Float64Array) {
    const levels = [boxes];
    while (levels[levels.length - 1].length > 6) levels.push(parentsOf(levels[levels.length - 1]));
    this.#levels = levels;
  }

  /** Returns the nearest box along origin + t·direction, t ≥ 0. Rays with non-finite components enter no box. */
  nearestEntry(origin: ArrayLike<number>, direction: ArrayLike<number>): BoxEntry {
    const top = this.#levels.length - 1;
    let testedBoxes = 0;
    let nearest = Number.POSITIVE_INFINITY;
    const visit = (level: number, from: number) => {
      const boxes = this.#levels[level];
      const end = Math.min(boxes.length / 6, from + ARITY);
      const entered: { readonly index: number; readonly distance: number }[] = [];
      for (let index = from; index < end; index++) {
        testedBoxes++;
        const distance = entryDistance(boxes, 6 * index, origin, direction);
        if (distance < nearest) entered.push({ index, distance });
      }
      entered.sort((a, b) => a.distance - b.distance);
      for (const { index, distance } of entered) {
        if (distance >= nearest) return;
        if (level === 0) nearest = distance;
        else visit(level - 1, ARITY * index);
      }
    };
    if (isFinite3(origin) && isFinite3(direction)) visit(top, 0);
    return { distance: nearest, testedBoxes };
  }
}

function parentsOf(boxes: Float64Array): Float64Array {
  const parents = new Float64Array(6 * Math.ceil(boxes.length / 6 / ARITY));
  for (let at = 0; at < parents.length; at += 6) {
    const children = boxes.subarray(ARITY * at, ARITY * (at + 6));
    for (let axis = 0; axis < 3; axis++) {
      parents[at + axis] = children[axis];
      parents[at + 3 + axis] = children[3 + axis];
      for (let child = 6; child < children.length; child += 6) {
        parents[at + axis] = Math.min(parents[at + axis], children[child + axis]);
        parents[at + 3 + axis] = Math.max(parents[at + 3 + axis], children[child + 3 + axis]);
      }
    }
  }
  return parents;
}

/** Distance at which the ray enters the box; Infinity if it misses. */
function entryDistance(
  boxes: Float64Array,
  at: number,
  origin: ArrayLike<number>,
  direction: ArrayLike<number>,
): number {
  let enter = 0;
  let leave = Number.POSITIVE_INFINITY;
  for (let axis = 0; axis < 3; axis++) {
    const toMin = boxes[at + axis] - origin[axis];
    const toMax = boxes[at + 3 + axis] - origin[axis];
    const d = direction[axis];
    if (d === 0) {
      // Parallel to the slab: always inside, or never. A division would give NaN on its faces.
      if (toMin > 0 || toMax < 0) return Number.POSITIVE_INFINITY;
    } else {
      enter = Math.max(enter, (d > 0 ? toMin : toMax) / d);
      leave = Math.min(leave, (d > 0 ? toMax : toMin) / d);
    }
  }
  return enter <= leave ? enter : Number.POSITIVE_INFINITY;
}

function isFinite3(v: ArrayLike<number>): boolean {
  return Number.isFinite(v[0]) && Number.isFinite(v[1]) && Number.isFinite(v[2]);
}
