/** Splats that a node is drawn as, at most. */
const MOST_COPIES = 4;

/** How a node that stands for others is drawn: several splats at the same place. */
export interface Stack {
  /** Opacities, from 0 to 1. */
  readonly opacities: readonly number[];
  /** Logarithm of a factor of its scales. */
  readonly growth: number;
}

/**
 * A node of opacity above 1, as the file has it, from 1 to 2. Spark draws it as so many splats of
 * opacity 1, not a whole number of them, one behind the other: 1 − (1 − g)ⁿ, where g is its
 * Gaussian and n = exp(((4 · opacity − 3)² − 1) / e). Here it is as many copies, the last one less
 * opaque. More than four are four that cover as much of a picture: n of them cover the harmonic
 * number of n times what one does.
 */
export function stackOf(opacity: number): Stack {
  if (!(opacity > 1)) return { opacities: [opacity], growth: 0 };
  const stacked = Math.exp(((4 * Math.min(opacity, 2) - 3) ** 2 - 1) / Math.E);
  const copies = Math.min(stacked, MOST_COPIES);
  const opacities = Array.from({ length: Math.ceil(copies) }, (_, i) => Math.min(1, copies - i));
  return { opacities, growth: Math.log(harmonicNumber(stacked) / harmonicNumber(copies)) / 2 };
}

/** ∫₀¹ (1 − tⁿ) / (1 − t) dt, for n of at least 1, to four digits. */
function harmonicNumber(n: number): number {
  return Math.log(n) + 0.5772156649 + 1 / (2 * n) - 1 / (12 * n * n) + 1 / (120 * n ** 4);
}
