import { InvalidArgumentError } from '@websplatter/core';
import { shallow } from 'zustand/vanilla/shallow';
import {
  annotationListKey,
  joinedAnnotations,
  readAnnotationList,
  writeAnnotationList,
} from '../annotate/annotation-list.ts';
import { canLink, isFallback } from '../engine/link/page-address.ts';
import type { SceneSource } from '../engine/open/scene-source.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { type Annotation, NO_ANNOTATIONS } from '../state/annotating.ts';
import type { LinkField } from '../state/link-parts.ts';
import { type KeptThing, withKept } from '../state/messages.ts';
import { FIRST_PATH, type PathSettings, type SavedView } from '../state/saved-view.ts';
import { SCENE_LINK_FIELDS } from '../state/scene-link-fields.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import { joinedViews, pathKey, readPath, readViewList, viewListKey } from './view-list.ts';

/**
 * Returns storage, such as `localStorage`. Called before each access, because browsers may forbid
 * it.
 */
export type StoryStorage = () => Pick<Storage, 'getItem' | 'setItem' | 'removeItem'>;

/** A list that belongs to a scene: in the store, in the URL and in the browser's storage. */
interface StoryList<Item> {
  /** Name of one item, for messages. */
  readonly name: string;
  readonly thing: KeptThing;
  readonly listIn: (state: ViewerState) => readonly Item[];
  readonly stateOf: (list: readonly Item[]) => Partial<ViewerState>;
  /** Query parameter, repeated for each item. */
  readonly field: Pick<LinkField<never, Item>, 'name' | 'decode'>;
  readonly keyOf: (contentKey: string) => string;
  readonly read: (text: string | null) => readonly Item[];
  readonly write: (list: readonly Item[]) => string;
  /** Items of the URL, then stored items that differ from them. */
  readonly joined: (linked: readonly Item[], kept: readonly Item[]) => readonly Item[];
}

const VIEWS: StoryList<SavedView> = {
  name: 'View',
  thing: 'views',
  listIn: ({ savedViews }) => savedViews,
  stateOf: (savedViews) => ({ savedViews }),
  field: SCENE_LINK_FIELDS.view,
  keyOf: viewListKey,
  read: readViewList,
  write: JSON.stringify,
  joined: joinedViews,
};

/** A list of one, or none if the path is as usual. */
const PATH: StoryList<PathSettings> = {
  name: 'Path',
  thing: 'path',
  listIn: ({ path }) => (path.isLooped || path.turntable ? [path] : []),
  stateOf: ([path = FIRST_PATH]) => ({ path, playheadMs: 0 }),
  field: SCENE_LINK_FIELDS.path,
  keyOf: pathKey,
  read: readPath,
  write: ([path]) => JSON.stringify(path),
  joined: (linked, kept) => (linked.length > 0 ? linked : kept),
};

const ANNOTATIONS: StoryList<Annotation> = {
  name: 'Annotation',
  thing: 'annotations',
  listIn: ({ annotating }) => annotating.list,
  stateOf: (list) => ({ annotating: { ...NO_ANNOTATIONS, list } }),
  field: SCENE_LINK_FIELDS.annotation,
  keyOf: annotationListKey,
  read: readAnnotationList,
  write: writeAnnotationList,
  joined: joinedAnnotations,
};

/**
 * Synchronises the store's saved views, path and annotations with the scene. Each scene gets the items
 * stored for its contents; the scene of the page's URL also gets the URL's items, which come first.
 * Changes are stored; unreadable parts of the URL are reported. Returns a function that stops this.
 *
 * @param storage null if nothing is to be stored, as in a page with only the picture.
 * @param isNamed whether the URL names the scene's files.
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
    keepList(PATH, panel.store, query, storage, isLinked),
    keepList(ANNOTATIONS, panel.store, query, storage, isLinked),
  ];
  return () => {
    for (const stop of stops) stop();
  };
}

/** Joins a query's views, path and annotations with those of the scene on the screen; the query's come first. */
export function storyOf(query: URLSearchParams, store: ViewerStore): Partial<ViewerState> {
  const joined = <Item>(story: StoryList<Item>) =>
    story.stateOf(story.joined(linkedItems(story, query, store), story.listIn(store.getState())));
  return { ...joined(VIEWS), ...joined(PATH), ...joined(ANNOTATIONS) };
}

function keepList<Item>(
  story: StoryList<Item>,
  store: ViewerStore,
  query: URLSearchParams,
  storage: StoryStorage | null,
  isLinked: () => boolean,
): () => void {
  // A settings file may have set some items already.
  let known = story.listIn(store.getState());
  let linked = story.joined(linkedItems(story, query, store), known);
  let contentKey: string | undefined;
  const read = () => {
    const kept = contentKey === undefined ? [] : story.read(textAt(story.keyOf(contentKey), storage));
    known = isLinked() ? story.joined(linked, kept) : kept;
    store.setState(story.stateOf(known));
  };
  const follow = (state: ViewerState) => {
    const list = story.listIn(state);
    if (state.scene?.contentKey !== contentKey) {
      contentKey = state.scene?.contentKey;
      store.setState((now) => withKept(now, story.thing));
      read();
    } else if (!shallow(list, known) && contentKey !== undefined) {
      const before = known;
      known = list;
      if (isLinked()) linked = list;
      const failure = storage && keep(contentKey, before, storage);
      store.setState((now) => withKept(now, story.thing, failure));
    }
  };
  /** Stores the list with what another tab has added to `before`. Returns the error if that fails. */
  const keep = (key: string, before: readonly Item[], storage: StoryStorage): unknown => {
    const name = story.keyOf(key);
    const isOthers = (item: Item) => story.joined(before, [item]).length > before.length;
    const list = story.joined(known, story.read(textAt(name, storage)).filter(isOthers));
    return errorOfWrite(name, list.length > 0 ? story.write(list) : null, storage);
  };
  read();
  follow(store.getState());
  return store.subscribe(follow);
}

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
    // Some windows have no storage.
    return null;
  }
}

/** Null if the text was stored. */
function errorOfWrite(key: string, text: string | null, storage: StoryStorage): unknown {
  try {
    if (text === null) storage().removeItem(key);
    else storage().setItem(key, text);
    return null;
  } catch (error) {
    return error;
  }
}
