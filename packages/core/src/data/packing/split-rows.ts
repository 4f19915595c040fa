import type { Turns } from '../turns.ts';

/** Rows between two chances of a thread to do something else. */
export const ROWS_AT_ONCE = 2048;

/** A binary tree that tells groups of rows apart, each node by one value of a row. */
export interface RowTree {
  /** By node, 0 being the root: which value of a row decides; −1 at leaves. */
  readonly axes: Int8Array;
  /** Rows whose value is below it belong to the first child. */
  readonly thresholds: Float64Array;
  /** By node: its first child, which the second follows; of leaves, their number from the left. */
  readonly children: Int32Array;
  readonly leafCount: number;
  /** By leaf: its first row; then the number of rows. */
  readonly starts: Uint32Array;
  /** The first leaf of each of about √leafCount subtrees, from left to right; then leafCount. */
  readonly cells: Uint32Array;
}

/**
 * Divides rows into at most `mostLeaves` groups of similar rows: again and again the group with the
 * largest sum of squared distances from its mean is cut at the mean of the value that varies most
 * (Su and Dy's Var-Part, which gives k-means a start that is better than random rows, and always
 * the same). Rows are put into the order of their leaves, and `ids` with them. Rows that are alike
 * stay together, so there may be fewer leaves.
 *
 * @param rows of `length` values each.
 */
export async function splitRows(
  rows: Float32Array,
  ids: Uint32Array,
  length: number,
  mostLeaves: number,
  turns: Turns,
): Promise<RowTree> {
  const most = 2 * mostLeaves - 1;
  const axes = new Int8Array(most).fill(-1);
  const thresholds = new Float64Array(most);
  const children = new Int32Array(most);
  const starts = new Uint32Array(most);
  const ends = new Uint32Array(most);
  const heap = new Heap(mostLeaves);
  const sums = new Float64Array(length);
  const squares = new Float64Array(length);

  /** Finds how the rows of a node vary, and where they are to be cut. */
  const measure = async (node: number) => {
    sums.fill(0);
    squares.fill(0);
    const [start, end] = [starts[node], ends[node]];
    for (let from = start; from < end; from += ROWS_AT_ONCE) {
      addMoments(rows, from, Math.min(end, from + ROWS_AT_ONCE), length, sums, squares);
      await turns.give();
    }
    const count = end - start;
    let widest = 0;
    let total = 0;
    let axis = -1;
    for (let k = 0; k < length; k++) {
      const variance = squares[k] - (sums[k] * sums[k]) / count;
      total += variance;
      if (variance > widest) [widest, axis] = [variance, k];
    }
    // Until it is cut, a leaf keeps its cut here.
    children[node] = axis;
    thresholds[node] = axis < 0 ? 0 : sums[axis] / count;
    if (axis >= 0 && count > 1) heap.push(node, total);
  };

  let nodes = 1;
  ends[0] = ids.length;
  await measure(0);
  let leafCount = 1;
  const cellCount = Math.ceil(Math.sqrt(mostLeaves));
  /** The number of nodes when there were as many leaves. */
  let cellNodes = 1;
  while (leafCount < mostLeaves) {
    const node = heap.pop();
    if (node < 0) break;
    const axis = children[node];
    const middle = await partition(
      rows,
      ids,
      starts[node],
      ends[node],
      length,
      axis,
      thresholds[node],
      turns,
    );
    // All are alike but for the rounding of their sums.
    if (middle === starts[node] || middle === ends[node]) continue;
    axes[node] = axis;
    children[node] = nodes;
    starts[nodes] = starts[node];
    ends[nodes] = starts[nodes + 1] = middle;
    ends[nodes + 1] = ends[node];
    await measure(nodes);
    await measure(nodes + 1);
    nodes += 2;
    leafCount++;
    if (leafCount <= cellCount) cellNodes = nodes;
  }

  const leafStarts = new Uint32Array(leafCount + 1);
  leafStarts[leafCount] = ids.length;
  const cells: number[] = [];
  let leaf = 0;
  const stack = [0];
  for (let node = stack.pop(); node !== undefined; node = stack.pop()) {
    const isLeaf = axes[node] < 0;
    if (node < cellNodes && (isLeaf || children[node] >= cellNodes)) cells.push(leaf);
    if (isLeaf) {
      leafStarts[leaf] = starts[node];
      children[node] = leaf++;
    } else stack.push(children[node] + 1, children[node]);
  }
  cells.push(leafCount);
  return { axes, thresholds, children, leafCount, starts: leafStarts, cells: Uint32Array.from(cells) };
}

/** The leaf that a row belongs to. */
export function leafOf({ axes, thresholds, children }: RowTree, row: Float32Array): number {
  let node = 0;
  while (axes[node] >= 0) node = children[node] + (row[axes[node]] < thresholds[node] ? 0 : 1);
  return children[node];
}

function addMoments(
  rows: Float32Array,
  from: number,
  to: number,
  length: number,
  sums: Float64Array,
  squares: Float64Array,
): void {
  for (let i = from * length; i < to * length; i += length) {
    for (let k = 0; k < length; k++) {
      const value = rows[i + k];
      sums[k] += value;
      squares[k] += value * value;
    }
  }
}

/** Moves rows below the threshold to the front; returns the index of the first other row. */
async function partition(
  rows: Float32Array,
  ids: Uint32Array,
  start: number,
  end: number,
  length: number,
  axis: number,
  threshold: number,
  turns: Turns,
): Promise<number> {
  let low = start;
  let high = end;
  let moved = 0;
  for (;;) {
    while (low < high && rows[low * length + axis] < threshold) low++;
    while (low < high && !(rows[(high - 1) * length + axis] < threshold)) high--;
    if (low >= high) return low;
    high--;
    const [a, b] = [low * length, high * length];
    for (let k = 0; k < length; k++) {
      const value = rows[a + k];
      rows[a + k] = rows[b + k];
      rows[b + k] = value;
    }
    const id = ids[low];
    ids[low] = ids[high];
    ids[high] = id;
    low++;
    if (++moved % ROWS_AT_ONCE === 0) await turns.give();
  }
}

/** Gives back the item of the largest priority; of equal ones, the one with the least number. */
class Heap {
  readonly #items: Int32Array;
  readonly #priorities: Float64Array;
  #length = 0;

  constructor(most: number) {
    this.#items = new Int32Array(most + 1);
    this.#priorities = new Float64Array(most + 1);
  }

  push(item: number, priority: number): void {
    let at = this.#length++;
    while (at > 0) {
      const parent = (at - 1) >> 1;
      if (!this.#isBefore(item, priority, parent)) break;
      this.#move(parent, at);
      at = parent;
    }
    this.#items[at] = item;
    this.#priorities[at] = priority;
  }

  /** −1 if there is none. */
  pop(): number {
    if (this.#length === 0) return -1;
    const first = this.#items[0];
    const last = --this.#length;
    const [item, priority] = [this.#items[last], this.#priorities[last]];
    let at = 0;
    for (;;) {
      let child = 2 * at + 1;
      if (child >= last) break;
      if (child + 1 < last && this.#isBefore(this.#items[child + 1], this.#priorities[child + 1], child))
        child++;
      if (this.#isBefore(item, priority, child)) break;
      this.#move(child, at);
      at = child;
    }
    this.#items[at] = item;
    this.#priorities[at] = priority;
    return first;
  }

  #isBefore(item: number, priority: number, place: number): boolean {
    const other = this.#priorities[place];
    return priority > other || (priority === other && item < this.#items[place]);
  }

  #move(from: number, to: number): void {
    this.#items[to] = this.#items[from];
    this.#priorities[to] = this.#priorities[from];
  }
}
