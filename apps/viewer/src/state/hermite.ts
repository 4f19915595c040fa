/** The cubic from `a` to `b` at `part` of the way, 0…1, with these slopes, per part, at both ends. */
export function hermite(a: number, slopeA: number, b: number, slopeB: number, part: number): number {
  const square = part * part;
  const cube = square * part;
  return (
    (2 * cube - 3 * square + 1) * a +
    (cube - 2 * square + part) * slopeA +
    (3 * square - 2 * cube) * b +
    (cube - square) * slopeB
  );
}
