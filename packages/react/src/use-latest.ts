import { type RefObject, useInsertionEffect, useRef } from 'react';

/** Returns a ref to the last render's value, for callbacks that must not be set up again. */
export function useLatest<T>(value: T): Readonly<RefObject<T>> {
  const latest = useRef(value);
  useInsertionEffect(() => {
    latest.current = value;
  });
  return latest;
}
