/** Most splats per node. */
const MOST_COPIES = 4;

/** Coincident splats that draw an inner node. */
interface Stack {
  /** Opacities, from 0 to 1. */
  readonly opacities: readonly number[];
  /** Log of a factor on the scales. */
  readonly growth: number;
}

/**
 * Splats for a node with a stored opacity above 1, up to 2. Spark draws the opacity 1 − (1 − g)ⁿ,
 * where g is the node's Gaussian and n = exp(((4 · opacity − 3)² − 1) / e). This equals n stacked
 * splats of opacity 1; here, the last copy has the fractional part of n as opacity. Above four
 * copies, four larger ones cover the same area: n copies cover harmonic number of n times the area
 * of one.
 */
export function stackOf(opacity: number): Stack {
  if (!(opacity > 1)) return { opacities: [opacity], growth: 0 };
  const stacked = Math.exp(((4 * Math.min(opacity, 2) - 3) ** 2 - 1) / Math.E);
  const copies = Math.min(stacked, MOST_COPIES);
  const opacities = Array.from({ length: Math.ceil(copies) }, (_, i) => Math.min(1, copies - i));
  return { opacities, growth: Math.log(harmonicNumber(stacked) / harmonicNumber(copies)) / 2 };
}

/** ∫₀¹ (1 − tⁿ) / (1 − t) dt for n ≥ 1, to four digits. */
function harmonicNumber(n: number): number {
  return Math.log(n) + 0.5772156649 + 1 / (2 * n) - 1 / (12 * n * n) + 1 / (120 * n ** 4);
}
