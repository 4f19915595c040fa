/** Splats as attributes of points. */
export const SPLATTING = 'KHR_gaussian_splatting';

/** Semantics of the coefficients up to a degree, in the order of rows. */
export function harmonicsSemantics(degree: number): string[] {
  return Array.from({ length: degree + 1 }, (_, l) =>
    Array.from({ length: 2 * l + 1 }, (_, n) => `${SPLATTING}:SH_DEGREE_${l}_COEF_${n}`),
  ).flat();
}
