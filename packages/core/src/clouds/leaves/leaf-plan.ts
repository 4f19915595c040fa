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

/** Demand of one view for a leaf. */
interface LeafDemand {
  readonly isInSight: boolean;
  /** Value per level; finer levels never have larger ones. */
  readonly values: readonly number[];
  wanted: number;
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
  const views = sights.map((sight) => demandOf(leaves, sight));
  const wanted = leaves.map(({ levels }, i) =>
    views.reduce((finest, view) => Math.min(finest, view[i].wanted), levels.length - 1),
  );
  const worthOf = (i: number, level: number) =>
    views.reduce((most, view) => (level > view[i].wanted ? Math.max(most, view[i].values[level]) : most), 0);
  const chunksOf = (i: number, level: number) => {
    const { levels } = leaves[i];
    return level + 1 < levels.length ? levels[level].chunkCount : 0;
  };
  const targets = refined(leaves, wanted, worthOf, chunksOf, roomChunks);
  return leaves.map(({ levels }, i) => ({
    isInSight: views.some((view) => view[i].isInSight),
    wanted: wanted[i],
    target: targets[i],
    value: worthOf(i, levels.length - 1),
  }));
}

/** The demand of one view for each leaf, within its budget of splats. */
function demandOf(leaves: readonly SceneLeaf[], sight: CloudSight): LeafDemand[] {
  const demand: LeafDemand[] = [];
  for (const leaf of leaves)
    demand.push(leafDemand(leaf, leaf.above === undefined ? undefined : demand[leaf.above], sight));
  const { budget } = sight;
  if (!budget) return demand;
  const splatsOf = (i: number, level: number) => (demand[i].isInSight ? leaves[i].levels[level].count : 0);
  const coarsest = leaves.reduce(
    (sum, { levels, above }, i) => sum + (above === undefined ? splatsOf(i, levels.length - 1) : 0),
    0,
  );
  const wanted = demand.map((leaf) => leaf.wanted);
  const within = refined(
    leaves,
    wanted,
    (i, level) => demand[i].values[level],
    splatsOf,
    budget.splats - coarsest,
  );
  for (const [i, leaf] of demand.entries()) leaf.wanted = within[i];
  return demand;
}

/** @param above the demand for the parent, whose value limits the leaf's. */
function leafDemand(
  { bounds, levels }: SceneLeaf,
  above: LeafDemand | undefined,
  { cut, sides, budget }: CloudSight,
): LeafDemand {
  if (!bounds) return { isInSight: true, values: levels.map(() => 0), wanted: 0 };
  // Bounds enclose each splat to one standard deviation.
  const largestScale = Math.hypot(...bounds.max.map((value, axis) => value - bounds.min[axis])) / 2;
  const isInSight =
    above?.isInSight !== false && sides.every((side) => reachesIn(side, bounds, largestScale));
  const threshold = Math.max(LEAST_SQUARED, squaredThreshold(bounds, cut));
  const most = above?.values[1] ?? Number.POSITIVE_INFINITY;
  const values = levels.map(({ error }) =>
    Math.min(most, (error * error * (isInSight ? 1 : OUT_OF_SIGHT)) / threshold),
  );
  const isFinest = isInSight && budget?.isFinest;
  return { isInSight, values, wanted: isFinest ? 0 : values.findLastIndex((value) => value <= 1) };
}

/**
 * Refines leaves from their coarsest level to the wanted one, the most valuable first. A leaf whose
 * next level does not fit stays as it is; so do its children.
 *
 * @param worthOf the value of refining a leaf of this level; never larger for finer levels.
 * @param sizeOf the room that this level of a leaf takes.
 */
function refined(
  leaves: readonly SceneLeaf[],
  wanted: readonly number[],
  worthOf: (leaf: number, level: number) => number,
  sizeOf: (leaf: number, level: number) => number,
  room: number,
): number[] {
  const reached = leaves.map(({ levels }) => levels.length - 1);
  const all = leaves.map(() => 0);
  let size = 0;
  for (const [leaf, coarsest] of reached.entries()) {
    const { above } = leaves[leaf];
    all[leaf] = above === undefined || all[above] === 0 ? wanted[leaf] : coarsest;
    size += sizeOf(leaf, all[leaf]) - sizeOf(leaf, coarsest);
  }
  // If everything fits, the expensive sort is not needed.
  if (size <= room) return all;
  const steps: { leaf: number; rank: number; level: number; value: number }[] = [];
  for (const [leaf, coarsest] of reached.entries())
    for (let level = coarsest; level > wanted[leaf]; level--)
      steps.push({ leaf, rank: leaves[leaf].rank ?? leaf, level, value: worthOf(leaf, level) });
  // No two steps tie, and a finer level never ranks above a coarser one of the same leaf.
  steps.sort((a, b) => b.value - a.value || a.rank - b.rank || b.level - a.level);
  let left = room;
  for (const { leaf, level } of steps) {
    const { above } = leaves[leaf];
    if (reached[leaf] !== level || (above !== undefined && reached[above] > 0)) continue;
    const size = sizeOf(leaf, level - 1) - sizeOf(leaf, level);
    if (size > left) continue;
    left -= size;
    reached[leaf] = level - 1;
  }
  return reached;
}
