import { type RefObject, useInsertionEffect, useRef, useState } from 'react';
import { isSameValue } from './effect-props.ts';

/** Returns a ref to the last render's value, for callbacks that must not be set up again. */
export function useLatest<T>(value: T): Readonly<RefObject<T>> {
  const latest = useRef(value);
  useInsertionEffect(() => {
    latest.current = value;
  });
  return latest;
}

/** Returns the first of equal values, so that a literal in each render keeps its identity. */
export function useSame<T>(value: T, isSame: (a: T, b: T) => boolean = isSameValue): T {
  const [kept, setKept] = useState(value);
  if (isSame(kept, value)) return kept;
  setKept(value);
  return value;
}

/** `useSame` for each property by itself. */
export function useSameOfEach<T extends object>(values: T): T {
  const [kept, setKept] = useState(values);
  const names = Object.keys(values) as (keyof T)[];
  const same = { ...values };
  for (const name of names) if (isSameValue(kept[name], values[name])) same[name] = kept[name];
  if (names.some((name) => same[name] !== kept[name])) setKept(same);
  return same;
}
