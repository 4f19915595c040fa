import { InvalidArgumentError } from '@websplatter/core';
import { canLink, isFallback, VIEW_PARAMETER } from '../links/page-address.ts';
import { decodeView } from '../links/view-text.ts';
import type { SavedView } from '../state/saved-view.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import { joinedViews, readViewList, viewListKey } from './view-list.ts';

/** Storage, such as `localStorage`; asked for each time: browsers may forbid it. */
export type StoryStorage = () => Pick<Storage, 'getItem' | 'setItem' | 'removeItem'>;

/**
 * Keeps the store's saved views in step with the scene: each scene has those that are kept by its
 * name, after those of the address if it is the scene that the address names. Changes are kept.
 * Unreadable parts of the address are told. Returns a function to stop this.
 */
export function keepStory(
  { store, viewer }: PanelProps,
  query: URLSearchParams,
  storage: StoryStorage,
): () => void {
  let linked = linkedViews(query, store);
  let known = store.getState().savedViews;
  const isLinked = () => {
    const sources = viewer.scenes.drawable?.parts.map(({ source }) => source) ?? [];
    return canLink(sources) && !isFallback(sources, query);
  };
  const read = (title: string | undefined) => {
    const kept = title === undefined ? [] : readViewList(textOf(title, storage));
    known = isLinked() ? joinedViews(linked, kept) : kept;
    store.setState({ savedViews: known });
  };
  read(store.getState().scene?.title);
  return store.subscribe(({ scene, savedViews }, before) => {
    if (scene?.title !== before.scene?.title) read(scene?.title);
    else if (savedViews !== known && scene) {
      known = savedViews;
      // The title changes as more files of the address arrive, and nothing else.
      if (isLinked()) linked = savedViews;
      if (!write(savedViews, scene.title, storage)) store.setState({ notice: NO_ROOM });
    }
  });
}

const NO_ROOM = 'The browser has no room for this view: it is gone when the page is closed.';

function linkedViews(query: URLSearchParams, store: PanelProps['store']): readonly SavedView[] {
  return query.getAll(VIEW_PARAMETER).flatMap((text, i) => {
    try {
      return [decodeView(text)];
    } catch (error) {
      if (!(error instanceof InvalidArgumentError)) throw error;
      const message = `View ${i + 1} of the address is left out. ${error.message}`;
      store.setState(({ notice }) => ({ notice: notice === null ? message : `${notice} ${message}` }));
      return [];
    }
  });
}

function textOf(title: string, storage: StoryStorage): string | null {
  try {
    return storage().getItem(viewListKey(title));
  } catch {
    // Some windows may keep nothing.
    return null;
  }
}

/** Returns whether the browser keeps it. */
function write(views: readonly SavedView[], title: string, storage: StoryStorage): boolean {
  try {
    if (views.length === 0) storage().removeItem(viewListKey(title));
    else storage().setItem(viewListKey(title), JSON.stringify(views));
    return true;
  } catch {
    return false;
  }
}
