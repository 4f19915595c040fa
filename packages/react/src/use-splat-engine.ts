import type { SplatEngine } from '@websplatter/core';
import { adoptRenderer, findSplatEngine } from '@websplatter/three';
import { useEffect, useReducer } from 'react';

/** The engine of a renderer, or why there is none; both null while it is being fetched. */
interface FoundEngine {
  readonly engine: SplatEngine | null;
  readonly failure: { readonly error: unknown } | null;
}

/** Returns the result of `findSplatEngine` for a renderer, and renders again when it changes. */
export function useFoundEngine(renderer: object | null | undefined): FoundEngine {
  const [, renderAgain] = useReducer((count: number) => count + 1, 0);
  const { engine, failure } = findIn(renderer);
  const awaited = engine || failure ? null : renderer;
  useEffect(() => {
    if (awaited) adoptRenderer(awaited).then(renderAgain, renderAgain);
  }, [awaited]);
  return { engine, failure };
}

/**
 * Returns the engine that draws splats for a renderer. Null without a renderer, and while the engine
 * for a renderer of the application's own is being fetched.
 *
 * @throws the errors of `findSplatEngine`.
 */
export function useSplatEngine(renderer: object | null | undefined): SplatEngine | null {
  const { engine, failure } = useFoundEngine(renderer);
  if (failure) throw failure.error;
  return engine;
}

function findIn(renderer: object | null | undefined): FoundEngine {
  try {
    return { engine: renderer ? findSplatEngine(renderer) : null, failure: null };
  } catch (error) {
    return { engine: null, failure: { error } };
  }
}
