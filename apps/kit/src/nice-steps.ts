/** About so many steps are worth telling apart between the ends of a slider. */
const STEPS = 200;

/** The largest 1, 2 or 5 times a power of ten with about 200 steps or more over `length`. */
export function stepFor(length: number): number {
  const wanted = length / STEPS;
  const power = Math.floor(Math.log10(wanted));
  const digits = [5, 2, 1].find((each) => timesPowerOfTen(each, power) <= wanted) ?? 1;
  return timesPowerOfTen(digits, power);
}

/** The smallest of 1, 2, 5, 10, 20, … and their tenths that is not below `value`; 0 for 0. */
export function roundAbove(value: number): number {
  if (value <= 0) return 0;
  const power = Math.floor(Math.log10(value));
  return timesPowerOfTen([1, 2, 5].find((each) => timesPowerOfTen(each, power) >= value) ?? 10, power);
}

/** The multiple of `step` that is next to `value`, as the shortest decimal. */
export function roundedTo(value: number, step: number): number {
  const count = Math.round(value / step);
  // Positive zero, too.
  return Number((count * step).toFixed(digitsAfterPoint(step))) + 0;
}

/** `value` with as many digits as the steps of its slider have. */
export function formatAt(value: number, step: number): string {
  const figure = value.toFixed(digitsAfterPoint(step));
  // A value that rounds to zero has no sign.
  return Number(figure) === 0 ? figure.replace('-', '') : figure.replace('-', '−');
}

function digitsAfterPoint(step: number): number {
  return Math.min(20, Math.max(0, -Math.floor(Math.log10(step))));
}

/** Exact to the last bit, as the product with a power would not be. */
function timesPowerOfTen(digits: number, power: number): number {
  return Number(`${digits}e${power}`);
}
