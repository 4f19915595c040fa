import type { SceneLeaf } from '../../data/bricks/leaf-scene.ts';
import type { CloudSight } from '../stream/cloud-sight.ts';
import { LEAST_SQUARED, OUT_OF_SIGHT, reachesIn, squaredThreshold } from '../stream/cloud-sight.ts';

/**
 * The planned state of a leaf. Levels are indices into its list of levels, 0 the finest. The
 * coarsest level of a leaf is resident wherever the finest level of its parent is.
 */
export interface PlannedLeaf {
  /** Whether any view has it in its frustum. */
  readonly isInSight: boolean;
  /** The coarsest level that is accurate enough for all views. */
  readonly wanted: number;
  /**
   * The finest level from `wanted` on that fits. Leaves stay at their coarsest level unless the
   * parent's target is its finest.
   */
  readonly target: number;
  /**
   * Squared ratio of the coarsest level's error to the error that the most demanding view
   * allows. Above 1, a finer level is wanted. Out of sight it is much smaller.
   */
  readonly value: number;
}

/** Demand of one view for all leaves. */
interface Demand {
  readonly isInSight: Uint8Array;
  /** Value of each level of each leaf, by `Shape`; finer levels never have larger ones. */
  readonly values: Float64Array;
  readonly wanted: Uint16Array;
}

/** Where the levels of leaves are in arrays of all levels. */
interface Shape {
  readonly leaves: readonly SceneLeaf[];
  /** Index of each leaf's finest level; coarser levels follow. */
  readonly starts: Uint32Array;
  readonly levelCount: number;
}

/**
 * Plans which level of each leaf to keep on the GPU. Leaves are refined level by level, the largest
 * excess of error first, as long as there is room. The plan depends on the views and the room
 * alone, not on resident levels.
 *
 * Splats per area are about equal wherever the error in pixels is equal. So this order removes the
 * most error for the room that it takes.
 *
 * @param roomChunks chunks for all levels but the coarsest ones, which have their own.
 */
export function planLeaves(
  leaves: readonly SceneLeaf[],
  sights: readonly CloudSight[],
  roomChunks: number,
): PlannedLeaf[] {
  const shape = shapeOf(leaves);
  const views = sights.map((sight) => demandOf(shape, sight));
  const wanted = Uint16Array.from(leaves, ({ levels }, i) =>
    views.reduce((finest, view) => Math.min(finest, view.wanted[i]), levels.length - 1),
  );
  const { starts, levelCount } = shape;
  const worths = new Float64Array(levelCount);
  const sizes = new Float64Array(levelCount);
  for (const [i, { levels }] of leaves.entries())
    for (let level = 0; level < levels.length; level++) {
      const at = starts[i] + level;
      for (const view of views)
        if (level > view.wanted[i]) worths[at] = Math.max(worths[at], view.values[at]);
      sizes[at] = level + 1 < levels.length ? levels[level].chunkCount : 0;
    }
  const targets = refined(shape, wanted, worths, sizes, roomChunks);
  return leaves.map(({ levels }, i) => ({
    isInSight: views.some(({ isInSight }) => isInSight[i] === 1),
    wanted: wanted[i],
    target: targets[i],
    value: worths[starts[i] + levels.length - 1],
  }));
}

function shapeOf(leaves: readonly SceneLeaf[]): Shape {
  const starts = new Uint32Array(leaves.length);
  let levelCount = 0;
  for (const [i, { levels }] of leaves.entries()) {
    starts[i] = levelCount;
    levelCount += levels.length;
  }
  return { leaves, starts, levelCount };
}

/** The demand of one view, within its budget of splats. */
function demandOf(shape: Shape, sight: CloudSight): Demand {
  const { leaves, starts, levelCount } = shape;
  const demand = {
    isInSight: new Uint8Array(leaves.length),
    values: new Float64Array(levelCount),
    wanted: new Uint16Array(leaves.length),
  };
  for (let i = 0; i < leaves.length; i++) addDemand(demand, shape, i, sight);
  const { budget } = sight;
  if (!budget) return demand;
  const sizes = new Float64Array(levelCount);
  let coarsest = 0;
  for (const [i, { levels, above }] of leaves.entries()) {
    if (demand.isInSight[i] === 0) continue;
    for (let level = 0; level < levels.length; level++) sizes[starts[i] + level] = levels[level].count;
    if (above === undefined) coarsest += levels[levels.length - 1].count;
  }
  const wanted = refined(shape, demand.wanted, demand.values, sizes, budget.splats - coarsest);
  return { ...demand, wanted };
}

/** Adds the demand for a leaf, whose parent's value limits its own. */
function addDemand(
  { isInSight, values, wanted }: Demand,
  { leaves, starts }: Shape,
  i: number,
  { cut, sides, budget }: CloudSight,
): void {
  const { bounds, levels, above } = leaves[i];
  if (!bounds) {
    isInSight[i] = 1;
    return;
  }
  // Bounds enclose each splat to one standard deviation.
  const [x, y, z] = [0, 1, 2].map((axis) => bounds.max[axis] - bounds.min[axis]);
  const largestScale = Math.hypot(x, y, z) / 2;
  const mayBeSeen = above === undefined || isInSight[above] === 1;
  const isSeen = mayBeSeen && sides.every((side) => reachesIn(side, bounds, largestScale));
  const threshold = Math.max(LEAST_SQUARED, squaredThreshold(bounds, cut));
  const most = above === undefined ? Number.POSITIVE_INFINITY : (values[starts[above] + 1] ?? 0);
  isInSight[i] = Number(isSeen);
  for (let level = 0; level < levels.length; level++) {
    const { error } = levels[level];
    const value = Math.min(most, (error * error * (isSeen ? 1 : OUT_OF_SIGHT)) / threshold);
    values[starts[i] + level] = value;
    if (value <= 1) wanted[i] = level;
  }
  if (isSeen && budget?.isFinest) wanted[i] = 0;
}

/**
 * Refines leaves from their coarsest level to the wanted one, the most valuable first. A leaf whose
 * next level does not fit stays as it is; so do its children.
 *
 * @param values of refining a leaf of a level, by `Shape`; never larger for finer levels.
 * @param sizes the room that each level takes.
 */
function refined(
  { leaves, starts, levelCount }: Shape,
  wanted: Uint16Array,
  values: Float64Array,
  sizes: Float64Array,
  room: number,
): Uint16Array {
  const reached = Uint16Array.from(leaves, ({ levels }) => levels.length - 1);
  const all = new Uint16Array(leaves.length);
  let size = 0;
  for (let leaf = 0; leaf < leaves.length; leaf++) {
    const { above } = leaves[leaf];
    all[leaf] = above === undefined || all[above] === 0 ? wanted[leaf] : reached[leaf];
    size += sizes[starts[leaf] + all[leaf]] - sizes[starts[leaf] + reached[leaf]];
  }
  // If everything fits, no order is needed.
  if (size <= room) return all;
  const steps = new Uint32Array(levelCount);
  const leafOf = new Uint32Array(levelCount);
  let stepCount = 0;
  for (let leaf = 0; leaf < leaves.length; leaf++)
    for (let level = reached[leaf]; level > wanted[leaf]; level--) {
      leafOf[starts[leaf] + level] = leaf;
      steps[stepCount++] = starts[leaf] + level;
    }
  const rankOf = (step: number) => leaves[leafOf[step]].rank ?? leafOf[step];
  // No two steps tie, and a finer level never ranks above a coarser one of the same leaf.
  const order = sortedByValue(steps.subarray(0, stepCount), values, (a, b) => rankOf(a) - rankOf(b) || b - a);
  let left = room;
  for (const step of order) {
    const leaf = leafOf[step];
    const { above } = leaves[leaf];
    if (starts[leaf] + reached[leaf] !== step || (above !== undefined && reached[above] > 0)) continue;
    const more = sizes[step - 1] - sizes[step];
    if (more > left) continue;
    left -= more;
    reached[leaf]--;
  }
  return reached;
}

/** Steps up to which comparing all is quicker than counting keys. */
const FEW_STEPS = 1024;
/** Bits of a float32 by which steps are sorted first: all of the exponent, and eight of the mantissa. */
const KEY_SHIFT = 15;
const f32 = new Float32Array(1);
const f32Bits = new Uint32Array(f32.buffer);

/**
 * Indices in descending order of their values, which are 0 or more. Sorted by counting, and exactly
 * among the few that are nearly equal: comparing all of several thousand would take milliseconds of
 * every frame.
 *
 * @param compare orders indices of equal values.
 */
function sortedByValue(
  indices: Uint32Array,
  values: Float64Array,
  compare: (a: number, b: number) => number,
): Uint32Array {
  const inOrder = (a: number, b: number) => values[b] - values[a] || compare(a, b);
  if (indices.length <= FEW_STEPS) return indices.slice().sort(inOrder);
  const keys = Uint32Array.from(indices, (index) => {
    f32[0] = values[index];
    return f32Bits[0] >>> KEY_SHIFT;
  });
  const largest = keys.reduce((most, key) => Math.max(most, key), 0);
  const ends = new Uint32Array(largest + 2);
  for (const key of keys) ends[largest - key + 1]++;
  for (let i = 1; i < ends.length; i++) ends[i] += ends[i - 1];
  const sorted = new Uint32Array(indices.length);
  const nexts = ends.slice();
  for (const [i, key] of keys.entries()) sorted[nexts[largest - key]++] = indices[i];
  for (let i = 0; i + 1 < ends.length; i++)
    if (ends[i + 1] - ends[i] > 1) sorted.subarray(ends[i], ends[i + 1]).sort(inOrder);
  return sorted;
}
