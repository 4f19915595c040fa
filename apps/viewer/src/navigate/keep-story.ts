import { InvalidArgumentError } from '@websplatter/core';
import {
  annotationListKey,
  joinedAnnotations,
  readAnnotationList,
  writeAnnotationList,
} from '../annotate/annotation-list.ts';
import { canLink, isFallback } from '../engine/page-address.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import type { SceneSource } from '../engine/scene-source.ts';
import { type Annotation, NO_ANNOTATIONS } from '../state/annotating.ts';
import type { LinkField } from '../state/link-parts.ts';
import type { SavedView } from '../state/saved-view.ts';
import { SCENE_LINK_FIELDS } from '../state/scene-link-fields.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import { joinedViews, readViewList, viewListKey } from './view-list.ts';

/** Storage, such as `localStorage`; asked for each time: browsers may forbid it. */
export type StoryStorage = () => Pick<Storage, 'getItem' | 'setItem' | 'removeItem'>;

/** A list that belongs to a scene: in the state, in the address and in the browser. */
interface StoryList<Item> {
  /** Of one item, for messages. */
  readonly name: string;
  readonly listIn: (state: ViewerState) => readonly Item[];
  readonly stateOf: (list: readonly Item[]) => Partial<ViewerState>;
  /** In the query, once for each item. */
  readonly field: Pick<LinkField<never, Item>, 'name' | 'decode'>;
  readonly keyOf: (sceneTitle: string) => string;
  readonly read: (text: string | null) => readonly Item[];
  readonly write: (list: readonly Item[]) => string;
  /** Items of the address, and then those that are kept. */
  readonly joined: (linked: readonly Item[], kept: readonly Item[]) => readonly Item[];
}

const VIEWS: StoryList<SavedView> = {
  name: 'View',
  listIn: ({ savedViews }) => savedViews,
  stateOf: (savedViews) => ({ savedViews }),
  field: SCENE_LINK_FIELDS.view,
  keyOf: viewListKey,
  read: readViewList,
  write: JSON.stringify,
  joined: joinedViews,
};

const ANNOTATIONS: StoryList<Annotation> = {
  name: 'Annotation',
  listIn: ({ annotating }) => annotating.list,
  stateOf: (list) => ({ annotating: { ...NO_ANNOTATIONS, list } }),
  field: SCENE_LINK_FIELDS.annotation,
  keyOf: annotationListKey,
  read: readAnnotationList,
  write: writeAnnotationList,
  joined: joinedAnnotations,
};

/**
 * Keeps the store's saved views and annotations in step with the scene: each scene has those that
 * are kept by its name, after those of the address if it is the scene that the address names.
 * Changes are kept. Unreadable parts of the address are told. Returns a function to stop this.
 *
 * @param storage null where nothing is kept, as by the picture alone.
 * @param isNamed whether the address names the files of a scene.
 */
export function keepStory(
  panel: PanelProps,
  query: URLSearchParams,
  storage: StoryStorage | null,
  isNamed = (sources: readonly SceneSource[]) => canLink(sources) && !isFallback(sources, query),
): () => void {
  const isLinked = () => isNamed(panel.viewer.scenes.drawable?.parts.map(({ source }) => source) ?? []);
  const stops = [
    keepList(VIEWS, panel.store, query, storage, isLinked),
    keepList(ANNOTATIONS, panel.store, query, storage, isLinked),
  ];
  return () => {
    for (const stop of stops) stop();
  };
}

function keepList<Item>(
  story: StoryList<Item>,
  store: ViewerStore,
  query: URLSearchParams,
  storage: StoryStorage | null,
  isLinked: () => boolean,
): () => void {
  // Settings may have some already.
  let known = story.listIn(store.getState());
  let linked = story.joined(linkedItems(story, query, store), known);
  let title: string | undefined;
  const read = () => {
    const kept = title === undefined ? [] : story.read(textAt(story.keyOf(title), storage));
    known = isLinked() ? story.joined(linked, kept) : kept;
    store.setState(story.stateOf(known));
  };
  const follow = (state: ViewerState) => {
    const list = story.listIn(state);
    if (state.scene?.title !== title) {
      title = state.scene?.title;
      read();
    } else if (list !== known && title !== undefined) {
      known = list;
      // The title changes as more files of the address arrive, and nothing else.
      if (isLinked()) linked = list;
      if (storage && !write(story.keyOf(title), list.length > 0 ? story.write(list) : null, storage))
        store.setState({ notice: NO_ROOM });
    }
  };
  read();
  follow(store.getState());
  return store.subscribe(follow);
}

const NO_ROOM = 'The browser has no room to keep this: it will be lost when the page is closed.';

function linkedItems<Item>(
  { name, field }: StoryList<Item>,
  query: URLSearchParams,
  store: ViewerStore,
): readonly Item[] {
  return query.getAll(field.name).flatMap((text, i) => {
    try {
      return [field.decode(text)];
    } catch (error) {
      if (!(error instanceof InvalidArgumentError)) throw error;
      const message = `${name} ${i + 1} of the address is left out. ${error.message}`;
      store.setState(({ notice }) => ({ notice: notice === null ? message : `${notice} ${message}` }));
      return [];
    }
  });
}

function textAt(key: string, storage: StoryStorage | null): string | null {
  try {
    return storage?.().getItem(key) ?? null;
  } catch {
    // Some windows may keep nothing.
    return null;
  }
}

/** Returns whether the browser keeps it. */
function write(key: string, text: string | null, storage: StoryStorage): boolean {
  try {
    if (text === null) storage().removeItem(key);
    else storage().setItem(key, text);
    return true;
  } catch {
    return false;
  }
}
