/** Whether two objects of one type have the same values in all fields, or are both null. */
export function hasSameFields<Fields extends object>(a: Fields | null, b: Fields | null): boolean {
  if (!a || !b || a === b) return a === b;
  // Quicker than by `Object.keys`: frames compare each of their clouds.
  for (const field in a) if (a[field] !== b[field]) return false;
  return true;
}
