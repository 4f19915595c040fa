import type { Turns } from '../../../data/turns.ts';

/** Most neighbours per entry. */
const NEIGHBOURS = 16;
/** Cells that are searched for the neighbours of an entry. */
const PROBED_CELLS = 8;
/** Entries between two yields to the event loop. */
const ENTRIES_AT_ONCE = 16;

/** Approximate nearest-entry search in a palette; nearly always exact. */
export class EntrySearch {
  readonly #entries: Float32Array;
  readonly #length: number;
  readonly #cells: Uint32Array;
  /** Mean of the entries in each cell. */
  readonly #means: Float32Array;
  /** NEIGHBOURS indices per entry, nearest first; −1 if there are fewer. */
  readonly #neighbours: Int32Array;
  /** Squared distance of each neighbour from its entry. */
  readonly #distances: Float64Array;
  readonly #nearestCells: Nearest;
  /** Squared distance of the last result of `nearest`. */
  distance = 0;
  #entry = 0;

  /**
   * @param entries entries of `length` values each.
   * @param cells index of the first entry of each group of nearby entries, then the number of
   *   entries.
   */
  private constructor(entries: Float32Array, length: number, cells: Uint32Array) {
    this.#entries = entries;
    this.#length = length;
    this.#cells = cells;
    this.#means = meansOf(entries, length, cells);
    const entryCount = cells[cells.length - 1];
    this.#neighbours = new Int32Array(entryCount * NEIGHBOURS).fill(-1);
    this.#distances = new Float64Array(entryCount * NEIGHBOURS);
    this.#nearestCells = new Nearest(Math.min(PROBED_CELLS, cells.length - 1));
  }

  /**
   * Finds the neighbours of each entry. Only entries of the nearest cells are compared, instead of
   * all pairs.
   *
   * @param reaches squared distance of the farthest row of each entry. Neighbours more than twice
   *   as far are omitted, because no row of the entry is nearer to them.
   * @param before search before the last move of the entries, whose neighbours are mostly still
   *   valid.
   */
  static async among(
    entries: Float32Array,
    length: number,
    cells: Uint32Array,
    reaches: Float64Array,
    before: EntrySearch | null,
    turns: Turns,
  ): Promise<EntrySearch> {
    const search = new EntrySearch(entries, length, cells);
    const nearest = new Nearest(NEIGHBOURS);
    for (let entry = 0; entry < reaches.length; entry++) {
      if (reaches[entry] === 0) continue;
      if (entry % ENTRIES_AT_ONCE === 0) await turns.give();
      const at = entry * length;
      const look = (other: number) => {
        const bound = nearest.bound;
        nearest.offer(other, squaredDistance(entries, at, entries, other * length, length, bound));
      };
      nearest.clear(4 * reaches[entry]);
      for (let i = entry * NEIGHBOURS; before && i < (entry + 1) * NEIGHBOURS; i++) {
        if (before.#neighbours[i] < 0) break;
        look(before.#neighbours[i]);
      }
      // The previous neighbours will be found again; anything farther than them can be excluded.
      nearest.clear(nearest.bound * (1 + Number.EPSILON));
      search.#findCells(entries, at);
      for (let i = 0; i < search.#nearestCells.count; i++) {
        const cell = search.#nearestCells.items[i];
        for (let other = cells[cell]; other < cells[cell + 1]; other++) if (other !== entry) look(other);
      }
      search.#neighbours.set(nearest.items.subarray(0, nearest.count), entry * NEIGHBOURS);
      search.#distances.set(nearest.distances.subarray(0, nearest.count), entry * NEIGHBOURS);
    }
    return search;
  }

  /**
   * Finds the nearest entry to a row. It walks from entry to entry while a neighbour is nearer, and
   * searches the nearest cells if the result is far away. `distance` is the squared distance of the
   * result.
   *
   * @param at index of the row's first value in `rows`.
   * @param from entry to start from.
   * @param farDistance squared distance above which the cells are searched.
   */
  nearest(rows: Float32Array, at: number, from: number, farDistance: number): number {
    this.#entry = from;
    this.distance = Number.POSITIVE_INFINITY;
    this.#look(rows, at, from);
    for (let left = -1; left !== this.#entry; ) {
      left = this.#entry;
      // By the triangle inequality, farther neighbours cannot be nearer to the row than the entry itself.
      const limit = 4 * this.distance;
      for (let i = left * NEIGHBOURS; i < (left + 1) * NEIGHBOURS; i++) {
        if (this.#neighbours[i] < 0 || this.#distances[i] >= limit) break;
        this.#look(rows, at, this.#neighbours[i]);
      }
    }
    if (this.distance > farDistance) {
      this.#findCells(rows, at);
      for (let i = 0; i < this.#nearestCells.count; i++) {
        const cell = this.#nearestCells.items[i];
        for (let other = this.#cells[cell]; other < this.#cells[cell + 1]; other++)
          this.#look(rows, at, other);
      }
    }
    return this.#entry;
  }

  /** Keeps an entry if it is nearer to a row than the best so far. */
  #look(rows: Float32Array, at: number, entry: number): void {
    const length = this.#length;
    const distance = squaredDistance(rows, at, this.#entries, entry * length, length, this.distance);
    if (distance >= this.distance) return;
    this.distance = distance;
    this.#entry = entry;
  }

  /** Finds the cells nearest to a row. */
  #findCells(rows: Float32Array, at: number): void {
    const length = this.#length;
    const nearest = this.#nearestCells;
    nearest.clear(Number.POSITIVE_INFINITY);
    for (let cell = 0; cell < this.#cells.length - 1; cell++)
      nearest.offer(cell, squaredDistance(rows, at, this.#means, cell * length, length, nearest.bound));
  }
}

function meansOf(entries: Float32Array, length: number, cells: Uint32Array): Float32Array {
  const means = new Float32Array((cells.length - 1) * length);
  for (let cell = 0; cell < cells.length - 1; cell++) {
    for (let k = 0; k < length; k++) {
      let sum = 0;
      for (let entry = cells[cell]; entry < cells[cell + 1]; entry++) sum += entries[entry * length + k];
      means[cell * length + k] = sum / (cells[cell + 1] - cells[cell]);
    }
  }
  return means;
}

/** Keeps the nearest few of the offered entries, nearest first. */
class Nearest {
  readonly items: Int32Array;
  readonly distances: Float64Array;
  count = 0;
  /** Only distances below this one are kept. */
  bound = 0;

  constructor(most: number) {
    this.items = new Int32Array(most);
    this.distances = new Float64Array(most);
  }

  clear(bound: number): void {
    this.count = 0;
    this.bound = bound;
  }

  offer(item: number, distance: number): void {
    if (distance >= this.bound) return;
    const { items, distances } = this;
    let at = this.count < items.length ? this.count++ : this.count - 1;
    for (; at > 0 && distances[at - 1] > distance; at--) {
      items[at] = items[at - 1];
      distances[at] = distances[at - 1];
    }
    items[at] = item;
    distances[at] = distance;
    if (this.count === items.length) this.bound = distances[this.count - 1];
  }
}

/**
 * Squared distance of two vectors of `length` values, a multiple of three, in `a` from `i` and in
 * `b` from `j` on. If the distance is at least `bound`, any number from `bound` on may be returned.
 */
export function squaredDistance(
  a: Float32Array,
  i: number,
  b: Float32Array,
  j: number,
  length: number,
  bound: number,
): number {
  let sum = 0;
  for (const end = i + length; i < end; i += 3, j += 3) {
    const x = a[i] - b[j];
    const y = a[i + 1] - b[j + 1];
    const z = a[i + 2] - b[j + 2];
    sum += x * x + y * y + z * z;
    if (sum >= bound) return sum;
  }
  return sum;
}
