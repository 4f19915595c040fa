import { type RefObject, useInsertionEffect, useRef } from 'react';

/** The value of the last render, for callbacks that must not be set up again whenever a caller's function is a new one. */
export function useLatest<T>(value: T): Readonly<RefObject<T>> {
  const latest = useRef(value);
  useInsertionEffect(() => {
    latest.current = value;
  });
  return latest;
}
