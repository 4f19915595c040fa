import type { LevelNode } from './merge-chunks.ts';

/**
 * Reference of merge-harmonics, in float64: the coefficients of a node, by those of the splats that
 * it stands for.
 */
export function mergedCoefficients(
  node: LevelNode,
  coefficientsOf: (splat: LevelNode) => ArrayLike<number>,
): number[] {
  if (node.children.length === 0) return Array.from(coefficientsOf(node));
  const [first, ...others] = node.children.map((child) => ({
    values: mergedCoefficients(child, coefficientsOf),
    share: child.merged.weight / node.merged.weight,
  }));
  if (others.length === 0) return first.values;
  return first.values.map((value, k) => first.share * value + others[0].share * others[0].values[k]);
}
