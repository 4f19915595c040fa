import type { Turns } from '../turns.ts';
import { squaredDistance } from './squared-distance.ts';

/** Most neighbours of an entry. */
const NEIGHBOURS = 16;
/** Cells whose entries are looked at for the neighbours of an entry. */
const PROBED_CELLS = 8;
/** Entries between two chances of a thread to do something else. */
const ENTRIES_AT_ONCE = 16;

/** Finds the nearest entry of a palette, in nearly all cases. */
export class EntrySearch {
  readonly #entries: Float32Array;
  readonly #length: number;
  readonly #cells: Uint32Array;
  /** Means of the entries of each cell. */
  readonly #means: Float32Array;
  /** NEIGHBOURS for each entry, nearest first; −1 where there are fewer. */
  readonly #neighbours: Int32Array;
  /** Squared distance from their entry. */
  readonly #distances: Float64Array;
  readonly #nearestCells: Nearest;

  /**
   * @param entries of `length` values each.
   * @param cells First entry of each group of entries that lie near each other, then the number of entries.
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
   * Finds the neighbours of each entry: among those of the nearest few cells, so that not all pairs need to be looked at.
   *
   * @param reaches By entry: the squared distance of its farthest row. Neighbours that are more than twice as far are left out: no row
   * of the entry is nearer to them.
   * @param before The search among the same entries before they were last moved, whose neighbours most still are.
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
      // They will be met again, and with them no others that are farther.
      nearest.clear(nearest.bound * (1 + Number.EPSILON));
      search.#findCells(entries, at);
      for (const cell of search.#nearestCells.found())
        for (let other = cells[cell]; other < cells[cell + 1]; other++) if (other !== entry) look(other);
      search.#neighbours.set(nearest.found(), entry * NEIGHBOURS);
      search.#distances.set(nearest.distances.subarray(0, nearest.count), entry * NEIGHBOURS);
    }
    return search;
  }

  /**
   * The nearest entry to a row that is found: goes from entry to entry for as long as a neighbour is nearer, and looks through the
   * nearest cells if that ends far away.
   *
   * @param at Where the row begins in `rows`.
   * @param from Entry to begin with.
   * @param farDistance Squared.
   */
  nearest(
    rows: Float32Array,
    at: number,
    from: number,
    farDistance: number,
  ): { entry: number; distance: number } {
    const entries = this.#entries;
    const length = this.#length;
    let entry = from;
    let distance = squaredDistance(rows, at, entries, entry * length, length, Number.POSITIVE_INFINITY);
    const look = (other: number) => {
      const toOther = squaredDistance(rows, at, entries, other * length, length, distance);
      if (toOther < distance) [entry, distance] = [other, toOther];
    };
    for (let left = -1; left !== entry; ) {
      left = entry;
      // None of those that follow can be nearer to the row than the entry itself.
      const limit = 4 * distance;
      for (let i = left * NEIGHBOURS; i < (left + 1) * NEIGHBOURS; i++) {
        if (this.#neighbours[i] < 0 || this.#distances[i] >= limit) break;
        look(this.#neighbours[i]);
      }
    }
    if (distance > farDistance) {
      this.#findCells(rows, at);
      for (const cell of this.#nearestCells.found())
        for (let other = this.#cells[cell]; other < this.#cells[cell + 1]; other++) look(other);
    }
    return { entry, distance };
  }

  /** Those nearest to a row. */
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

/** The nearest few of what is offered, nearest first. */
class Nearest {
  readonly #items: Int32Array;
  readonly distances: Float64Array;
  count = 0;
  #limit = 0;

  constructor(most: number) {
    this.#items = new Int32Array(most);
    this.distances = new Float64Array(most);
  }

  clear(limit: number): void {
    this.count = 0;
    this.#limit = limit;
  }

  found(): Int32Array {
    return this.#items.subarray(0, this.count);
  }

  /** What is not nearer is not among them. */
  get bound(): number {
    return this.count < this.#items.length ? this.#limit : this.distances[this.count - 1];
  }

  offer(item: number, distance: number): void {
    if (distance >= this.bound) return;
    let at = this.count < this.#items.length ? this.count++ : this.count - 1;
    for (; at > 0 && this.distances[at - 1] > distance; at--) {
      this.#items[at] = this.#items[at - 1];
      this.distances[at] = this.distances[at - 1];
    }
    this.#items[at] = item;
    this.distances[at] = distance;
  }
}
