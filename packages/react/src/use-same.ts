import { useState } from 'react';

/** The first of equal values: written out anew in every render, it still changes nothing. */
export function useSame<T>(value: T, isSame: (a: T, b: T) => boolean): T {
  const [kept, setKept] = useState(value);
  if (isSame(kept, value)) return kept;
  setKept(value);
  return value;
}
