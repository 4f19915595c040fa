import { context, type RootState } from '@react-three/fiber';
import { InvalidArgumentError } from '@websplatter/core';
import { useContext } from 'react';

/** Returns the renderer of a Canvas, which @react-three/fiber 10 calls `renderer`. */
export function rendererOf(state: RootState & { readonly renderer?: object }): object {
  return state.renderer ?? state.gl;
}

/** Returns the surrounding Canvas's renderer, which it keeps for life; undefined outside of one. */
export function useCanvasRenderer(): object | undefined {
  const store = useContext(context);
  return store ? rendererOf(store.getState()) : undefined;
}

/**
 * Returns the renderer that is given, or else the one of the surrounding Canvas; null for a renderer
 * that is not there yet.
 *
 * @param given arguments that give a renderer: one, or none. Outside of a Canvas it may be null or
 *   undefined until the Canvas has made it.
 * @param who name of the component or hook, for messages.
 * @throws InvalidArgumentError outside of a Canvas without such an argument.
 */
export function useMeasuredRenderer(
  given: readonly (object | null | undefined)[],
  who: string,
): object | null {
  const canvas = useCanvasRenderer();
  const [renderer = canvas] = given;
  if (renderer !== undefined) return renderer;
  if (given.length > 0) return null;
  throw new InvalidArgumentError('renderer', `Outside of a Canvas, ${who} needs its renderer.`);
}
