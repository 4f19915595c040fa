import type { ViewerStore } from '../state/store.ts';
import { readViewList, viewListKey } from './view-list.ts';

/** Storage of views, such as `localStorage`; asked for each time: browsers may forbid it. */
export type ViewStorage = () => Pick<Storage, 'getItem' | 'setItem' | 'removeItem'>;

/**
 * Keeps the store's list of saved views in step with the scene; returns a function to stop this.
 *
 * @param onRead called before each time that the list is another scene's.
 */
export function watchViewList(store: ViewerStore, storage: ViewStorage, onRead = () => {}): () => void {
  const read = () => {
    onRead();
    const title = store.getState().scene?.title;
    let text: string | null = null;
    try {
      text = title === undefined ? null : storage().getItem(viewListKey(title));
    } catch {
      // Some windows may keep nothing: the list is empty.
    }
    store.setState({ savedViews: readViewList(text) });
  };
  read();
  return store.subscribe(({ scene }, before) => {
    if (scene?.title !== before.scene?.title) read();
  });
}
