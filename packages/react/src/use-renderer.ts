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
 * Returns `given`, or the renderer of the surrounding Canvas if it is undefined.
 *
 * @param who name of the component or hook, for messages.
 * @throws InvalidArgumentError if there is neither.
 */
export function useMeasuredRenderer<Given extends object | null>(
  given: Given | undefined,
  who: string,
): object | Given {
  const renderer = useCanvasRenderer();
  const measured = given === undefined ? renderer : given;
  if (measured !== undefined) return measured;
  throw new InvalidArgumentError('renderer', `Outside of a Canvas, ${who} needs its renderer.`);
}
