const numbers = new WeakMap<object, number>();
let numbersGiven = 0;

/** Returns a number that is unique to `thing`, for keys made of text. */
export function numberOf(thing: object): number {
  const number = numbers.get(thing) ?? ++numbersGiven;
  numbers.set(thing, number);
  return number;
}
