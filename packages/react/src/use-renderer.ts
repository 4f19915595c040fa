import { context, type RootState } from '@react-three/fiber';
import { useContext } from 'react';

/** Returns the renderer of a Canvas, which @react-three/fiber 10 calls `renderer`. */
export function rendererOf(state: RootState & { readonly renderer?: object }): object {
  return state.renderer ?? state.gl;
}

/** Returns the renderer of the surrounding Canvas; undefined outside of one. A Canvas keeps its renderer for life. */
export function useCanvasRenderer(): object | undefined {
  const store = useContext(context);
  return store ? rendererOf(store.getState()) : undefined;
}
