import { isGpuLost } from '../state/session.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';

/** The viewer's state for style sheets and tests (`data-state` of the root element). */
export type DocumentState = 'starting' | 'loading' | 'ready' | 'error' | 'unavailable' | 'lost';

export function documentState(state: ViewerState): DocumentState {
  if (state.status === 'unavailable') return 'unavailable';
  if (isGpuLost(state)) return 'lost';
  if (state.load) return 'loading';
  if (state.failure) return 'error';
  return state.status === 'running' && state.scene ? 'ready' : 'starting';
}

export function documentTitle({ scene }: ViewerState): string {
  return scene ? `${scene.title} · WebSplatter` : 'WebSplatter';
}

/**
 * Synchronises the document's state and title with the store; returns a function that stops this.
 *
 * @param titleOf the title for a state.
 */
export function mirrorToDocument(store: ViewerStore, target: Document, titleOf = documentTitle): () => void {
  const write = (state: ViewerState) => {
    const word = documentState(state);
    const title = titleOf(state);
    // Written only on change: the store changes with every frame.
    if (target.documentElement.dataset.state !== word) target.documentElement.dataset.state = word;
    if (target.title !== title) target.title = title;
  };
  write(store.getState());
  return store.subscribe(write);
}
