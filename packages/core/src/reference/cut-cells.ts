import { threshold } from './level-link.ts';

/** The parts of `CutParameters` that thresholds follow from. */
export interface CutValues {
  readonly camera: ArrayLike<number>;
  readonly squaredPerDistance: number;
  readonly leastSquared: number;
  readonly margin: number;
}

/** Reference of cut-cells: the threshold of a cell with these bounds of centres. */
export function cellThreshold(
  { min, max }: { readonly min: ArrayLike<number>; readonly max: ArrayLike<number> },
  { camera, squaredPerDistance, leastSquared, margin }: CutValues,
): number {
  const apart = [0, 1, 2].map((axis) =>
    Math.max(0, Math.max(min[axis] - camera[axis], camera[axis] - max[axis]) - margin),
  );
  const distance2 = apart.reduce((sum, each) => sum + each * each, 0);
  return threshold(Math.max(distance2 * squaredPerDistance, leastSquared));
}
