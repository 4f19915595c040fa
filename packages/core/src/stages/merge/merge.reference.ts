import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { blobError } from '../../reference/level-link.ts';
import { type Merged, merge, mergeCost } from '../../reference/merged-splat.ts';

const { CELL_ROOTS, MERGED_RADIUS } = LEVEL_CONSTANTS;

/** A splat or a blob of a cell. */
export interface LevelNode {
  readonly merged: Merged;
  readonly error: number;
  /** Merged nodes: two; none for a splat; one for a root that has merged with no other. */
  readonly children: readonly LevelNode[];
}

/** Blobs of a cell in the order of their slots, and the roots among them. */
export interface MergedCell {
  readonly blobs: readonly LevelNode[];
  readonly roots: readonly LevelNode[];
}

/**
 * Reference of merge-chunks, in float64, for one cell.
 *
 * @param errors errors of the splats, if they are roots of the level below; default 0.
 */
export function mergeCell(splats: readonly Merged[], errors: readonly number[] = []): MergedCell {
  const blobs: LevelNode[] = [];
  let nodes: LevelNode[] = splats.map((merged, i) => ({ merged, error: errors[i] ?? 0, children: [] }));
  while (nodes.length > CELL_ROOTS) {
    const nearest = nodes.map((_, i) => nearestTo(nodes, i));
    const firsts = nodes.flatMap((_, i) => (nearest[i] > i && nearest[nearest[i]] === i ? [i] : []));
    const merging = firsts.slice(0, nodes.length - CELL_ROOTS);
    const gone = new Set<number>();
    for (const i of merging) {
      const [a, b] = [nodes[i], nodes[nearest[i]]];
      const error = blobError(Math.sqrt(mergeCost(a.merged, b.merged)));
      const merged = merge(a.merged, b.merged);
      nodes[i] = { merged, error: Math.max(error, a.error, b.error), children: [a, b] };
      gone.add(nearest[i]);
      blobs.push(nodes[i]);
    }
    nodes = nodes.filter((_, i) => !gone.has(i));
  }
  const roots = nodes.map((node): LevelNode => {
    if (node.children.length > 0) return node;
    const blob = { merged: node.merged, error: Math.max(node.error, 1), children: [node] };
    blobs.push(blob);
    return blob;
  });
  return { blobs, roots };
}

function nearestTo(nodes: readonly LevelNode[], i: number): number {
  let [least, found] = [Number.POSITIVE_INFINITY, i];
  const last = Math.min(i + MERGED_RADIUS, nodes.length - 1);
  for (let j = Math.max(i - MERGED_RADIUS, 0); j <= last; j++) {
    const cost =
      j === i
        ? Number.POSITIVE_INFINITY
        : mergeCost(nodes[Math.min(i, j)].merged, nodes[Math.max(i, j)].merged);
    if (cost < least) [least, found] = [cost, j];
  }
  return found;
}

/**
 * Reference of merge-harmonics, in float64: the coefficients of a node, from the coefficients of the
 * splats that it stands for.
 */
export function mergedCoefficients(
  node: LevelNode,
  coefficientsOf: (splat: LevelNode) => ArrayLike<number>,
): number[] {
  if (node.children.length === 0) return Array.from(coefficientsOf(node));
  const weight = node.children.reduce((sum, child) => sum + child.merged.weight, 0);
  const [first, ...others] = node.children.map((child) => ({
    values: mergedCoefficients(child, coefficientsOf),
    share: child.merged.weight / weight,
  }));
  if (others.length === 0) return first.values;
  return first.values.map((value, k) => first.share * value + others[0].share * others[0].values[k]);
}
