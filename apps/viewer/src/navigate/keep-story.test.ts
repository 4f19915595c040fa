import { builtinScenes } from '@websplatter/scenes';
import { expect, it } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import type { SceneSource } from '../engine/open/scene-source.ts';
import type { Viewer } from '../engine/viewer.ts';
import { NO_ANNOTATIONS } from '../state/annotating.ts';
import { FIRST_PATH, type SavedView } from '../state/saved-view.ts';
import type { SceneSummary } from '../state/scene.ts';
import { createViewerStore } from '../state/store.ts';
import { keepStory, type StoryStorage, storyOf } from './keep-story.ts';

const BUILTIN: SceneSource = { kind: 'builtin', scene: builtinScenes[0] };
const FILE: SceneSource = { kind: 'file', name: 'a.ply', source: new File([], 'a.ply') };
const VIEW: SavedView = {
  ...{ pose: FRONT, fovDegrees: 50, isOrthographic: false, isFlipped: false, isZUp: false },
  ...{ name: 'Front', thumbnail: '/9j/' },
};
const LINKED = 'view=0,0,0,10,0,1.5708,name:Linked&view=1,0,0,4,0,1';

/** A page at this address, in a browser that has kept something. */
function opened(address = '', kept: Map<string, string> | null = new Map(), change: Partial<Storage> = {}) {
  const store = createViewerStore();
  let parts: readonly { source: SceneSource }[] = [];
  const viewer = {
    scenes: {
      drawable: {
        get parts() {
          return parts;
        },
      },
    },
  } as unknown as Viewer;
  const storage = {
    getItem: (key: string) => kept?.get(key) ?? null,
    setItem: (key: string, text: string) => void kept?.set(key, text),
    removeItem: (key: string) => void kept?.delete(key),
    ...change,
  };
  const show = (contentKey: string, ...sources: readonly SceneSource[]) => {
    parts = sources.map((source) => ({ source }));
    // Every training writes this name.
    store.setState({ scene: { title: 'point_cloud.ply', contentKey } as SceneSummary });
  };
  keepStory({ store, viewer }, new URLSearchParams(address), kept && ((() => storage) as StoryStorage));
  const names = () => store.getState().savedViews.map(({ name }) => name);
  return { store, show, kept: kept ?? new Map(), names };
}

it('keeps views by what the scene holds, whatever its name, until the last of them is removed', () => {
  const { store, show, kept } = opened();
  show('a', BUILTIN);
  store.setState({ savedViews: [VIEW] });
  const again = opened('', kept);
  again.show('b', FILE);
  expect(again.store.getState().savedViews).toEqual([]);
  again.show('a', BUILTIN);
  expect(again.store.getState().savedViews).toEqual([VIEW]);
  store.setState({ savedViews: [] });
  expect(kept.size).toBe(0);
});

it('gives the scene of the address the views of the address, before those that are kept', () => {
  const { show, kept, store } = opened();
  show('a', BUILTIN);
  store.setState({ savedViews: [{ ...VIEW, name: 'Own', fovDegrees: 20 }, VIEW] });
  const linked = opened(LINKED, kept);
  linked.show('own file', FILE);
  expect(linked.names()).toEqual([]);
  linked.show('a', BUILTIN);
  expect(linked.names()).toEqual(['Linked', '', 'Own']);
  // What is seen is as it was kept.
  expect(linked.store.getState().savedViews[0].thumbnail).toBe('/9j/');
  linked.store.setState({ savedViews: linked.store.getState().savedViews.slice(1, 2) });
  linked.show('own file', FILE);
  linked.show('a', BUILTIN);
  expect(linked.store.getState().savedViews.map(({ pose }) => pose.distance)).toEqual([4]);
});

it('keeps the views of the address while more of its files arrive', () => {
  const { show, names } = opened(`src=a.ply&src=b.ply&${LINKED}`);
  const [a, b] = ['a', 'b'].map(
    (name): SceneSource => ({ kind: 'url', url: new URL(`http://localhost/${name}.ply`) }),
  );
  show('a.ply', a);
  show('a.ply', a, b);
  expect(names()).toEqual(['Linked', '']);
});

it('keeps the path of a scene, and gives that of the address to its scene', () => {
  const { store, show, kept } = opened();
  show('a', BUILTIN);
  store.setState({ path: { isLooped: true, turntable: null }, playheadMs: 700 });
  show('b', FILE);
  expect(store.getState()).toMatchObject({ path: FIRST_PATH, playheadMs: 0 });
  show('a', BUILTIN);
  expect(store.getState().path.isLooped).toBe(true);
  const linked = opened('path=turntable:4,0,0,0,10,0,1', kept);
  linked.show('a', BUILTIN);
  expect(linked.store.getState().path.turntable?.durationMs).toBe(4000);
  linked.store.setState({ path: FIRST_PATH });
  expect(kept.size).toBe(0);
});

it('leaves out a view that cannot be read, and says which', () => {
  const { show, store, names } = opened('view=near&view=0,0,0,10,0,1');
  show('a', BUILTIN);
  expect(names()).toEqual(['']);
  expect(store.getState().notice).toMatch(/^View 1 of the address is left out\. .*“near” is no number/);
});

it('says where the browser has no room, or may keep nothing', () => {
  const refuse = () => {
    throw new DOMException('Full.', 'QuotaExceededError');
  };
  const { store, show, names } = opened('', new Map(), { getItem: refuse, setItem: refuse });
  show('a', BUILTIN);
  store.setState({ savedViews: [VIEW] });
  expect(names()).toEqual(['Front']);
  expect([...store.getState().unkept.keys()]).toEqual(['views']);
});

/**
 * @fault Order: two tabs on one file store views and annotations
 * @consequence Each adds its own, and removes its own: those of the other tab stay.
 */
it('stores views beside those that another tab has stored meanwhile', () => {
  const kept = new Map<string, string>();
  const [first, second] = [opened('', kept), opened('', kept)];
  const view = (name: string, fovDegrees: number): SavedView => ({ ...VIEW, name, fovDegrees });
  const [ofA, ofB] = [view('A', 20), view('B', 30)];
  for (const page of [first, second]) page.show('a', FILE);
  first.store.setState({ savedViews: [VIEW, ofA] });
  second.store.setState({ savedViews: [ofB] });
  const reloaded = () => {
    const page = opened('', kept);
    page.show('a', FILE);
    return page.names();
  };
  expect(reloaded()).toEqual(['B', 'Front', 'A']);
  first.store.setState({ savedViews: [view('A, again', 20)] });
  expect(reloaded()).toEqual(['A, again', 'B']);
  second.store.setState({ savedViews: [] });
  expect(reloaded()).toEqual(['A, again']);
});

it('is content again once there is room', () => {
  const kept = new Map<string, string>();
  let isFull = true;
  const setItem = (key: string, text: string) => {
    if (isFull) throw new DOMException('Full.', 'QuotaExceededError');
    kept.set(key, text);
  };
  const { store, show } = opened('', kept, { setItem });
  show('a', FILE);
  store.setState({ savedViews: [VIEW] });
  expect(store.getState().unkept.size).toBe(1);
  show('b', FILE);
  expect(store.getState().unkept.size).toBe(0);
  store.setState({ savedViews: [VIEW] });
  isFull = false;
  store.setState({ savedViews: [VIEW, { ...VIEW, fovDegrees: 20 }] });
  expect(store.getState().unkept.size).toBe(0);
});

it('does the same for annotations, which the picture alone has from its address only', () => {
  const { show, kept, store } = opened();
  show('a', BUILTIN);
  const own = { point: [0, 0, 0], title: 'Own', text: '', view: VIEW } as const;
  store.setState({ annotating: { ...NO_ANNOTATIONS, list: [own] } });
  const address = `${LINKED}&annotation=1:0:0,0,0,0,10,0,1,words:Linked`;
  const linked = opened(address, kept);
  linked.show('a', BUILTIN);
  expect(linked.names()).toEqual(['Linked', '']);
  expect(linked.store.getState().annotating.list.map(({ title }) => title)).toEqual(['Linked', 'Own']);
  const alone = opened(address, null);
  alone.show('a', BUILTIN);
  expect(alone.store.getState().annotating.list.map(({ title }) => title)).toEqual(['Linked']);
  alone.store.setState({ savedViews: [] });
});

it('has the story of a project before what the scene has', () => {
  const { store, show } = opened();
  show('a', FILE);
  store.setState({ savedViews: [{ ...VIEW, fovDegrees: 33 }] });
  store.setState(storyOf(new URLSearchParams(`${LINKED}&path=loop`), store));
  const { savedViews, path, annotating } = store.getState();
  expect(savedViews.map(({ name }) => name)).toEqual(['Linked', '', 'Front']);
  expect([path.isLooped, annotating]).toEqual([true, NO_ANNOTATIONS]);
});
