/** Numbers and vectors of an effect's list by name, in the order in which its shader reads them. */
export type NamedNumbers = Readonly<Record<string, number | ArrayLike<number>>>;

/** Returns all of them as one list. */
export function numbersOf(named: NamedNumbers): number[] {
  return Object.values(named).flatMap((value) => (typeof value === 'number' ? value : Array.from(value)));
}
