/** A round value of an axis. */
export interface Tick {
  readonly value: number;
  readonly text: string;
}

/**
 * The round values within a range, lowest first, at steps of 1, 2 or 5 times a power of ten, with
 * as many decimals as the step needs.
 *
 * @param range not empty.
 * @param most how many steps the range has at most, at least 1.
 */
export function ticksIn([from, to]: readonly [number, number], most: number): Tick[] {
  const power = Math.floor(Math.log10((to - from) / most));
  const factor = [1, 2, 5].find((each) => (to - from) / (each * 10 ** power) <= most);
  const [step, decimals] = factor
    ? [factor * 10 ** power, Math.max(0, -power)]
    : [10 ** (power + 1), Math.max(0, -power - 1)];
  const first = Math.ceil(from / step);
  const count = Math.max(0, Math.floor(to / step) - first + 1);
  return Array.from({ length: count }, (_, i) => {
    const value = (first + i) * step;
    return { value, text: value.toFixed(decimals) };
  });
}
