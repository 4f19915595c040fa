import { beforeEach, expect, it, vi } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { describeEdits } from '../state/describe-edits.ts';
import { NO_HISTORY } from '../state/history.ts';
import { type Inspecting, NOTHING_INSPECTED } from '../state/inspecting.ts';
import { undoEdit } from '../state/make-edit.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import { keepWork } from './keep-work.ts';
import type { VersionPlace, VersionStore, WorkRecord } from './version-store.ts';

const CROP = { min: [0, 0, 0], max: [1, 1, 1], keep: 'inside' } as const;
const CAMERA = { pose: FRONT, fovDegrees: 50, isOrthographic: false, isFlipped: false, isZUp: false };

/** What the browser has, over several loads of the page: records by scene and version. */
let records: Map<string, { readonly place: VersionPlace; readonly work: WorkRecord }>;
/** Versions that a tab goes on with. */
let open: Set<string>;
let watchers: Set<{ readonly tab: object; readonly onChange: (key: string) => void }>;
let failure: Error | null;
let page: EventTarget;

beforeEach(() => {
  vi.useFakeTimers();
  [records, open, watchers, failure] = [new Map(), new Set(), new Set(), null];
  page = new EventTarget();
  vi.stubGlobal('addEventListener', page.addEventListener.bind(page));
  return () => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  };
});

/** A tab's own storage, which a reload keeps, and a copy of the tab begins with. */
interface Tab {
  versionOfTab: VersionPlace | null;
}

const newTab = (): Tab => ({ versionOfTab: null });

function storeOf(tab: Tab): VersionStore {
  const nameOf = ({ key, id }: VersionPlace) => `${key} ${id}`;
  return {
    read: async (key) => {
      const found = [...records.values()].filter(({ place }) => place.key === key);
      return found.map(({ place: { id }, work }) => ({ id, work, isOpen: open.has(id) }));
    },
    write: async (place, work) => {
      if (failure) throw failure;
      records.set(nameOf(place), { place, work });
    },
    clear: async (place) => records.delete(nameOf(place)),
    get versionOfTab() {
      return tab.versionOfTab;
    },
    set versionOfTab(place) {
      tab.versionOfTab = place;
    },
    hold: (id) => {
      open.add(id);
      return () => open.delete(id);
    },
    tell: (key) => {
      for (const each of watchers) if (each.tab !== tab) each.onChange(key);
    },
    watch: (onChange) => {
      const watcher = { tab, onChange };
      watchers.add(watcher);
      return () => watchers.delete(watcher);
    },
  };
}

/** All timers have run, and code that was asked for has come. */
async function settled(): Promise<void> {
  await vi.advanceTimersByTimeAsync(1000);
  await vi.dynamicImportSettled();
  await vi.advanceTimersByTimeAsync(1000);
}

let opened = 0;

/** A page in a tab that shows nothing yet. */
function load(tab = newTab()) {
  const store = createViewerStore();
  const newest = { parts: [] as unknown[] };
  let distance = 4;
  const camera = {
    snapshot: () => ({ ...CAMERA, pose: { ...FRONT, distance }, cameraIndex: 0 }),
    showLinked: vi.fn(({ pose }) => {
      distance = pose.distance;
    }),
    setLook: vi.fn(),
  };
  const viewer = {
    scenes: { newest },
    camera,
    setEffects: vi.fn(),
    setAccuracy: vi.fn(),
    setTarget: vi.fn(),
  };
  const stop = keepWork({ store, viewer } as unknown as PanelProps, storeOf(tab));
  const open = async (name: string, kind = 'file', count = 100, key = ++opened) => {
    const cloud = { count, dropped: {}, facts: {}, stream: null };
    newest.parts = [
      { key, contentKey: name, source: { kind, name }, look: {}, loaded: { clouds: [{ cloud }] } },
    ];
    store.setState({
      scene: { title: name } as never,
      inspecting: NOTHING_INSPECTED,
      ...NO_HISTORY,
      load: null,
    });
    await settled();
    return key;
  };
  const edit = async (change: Partial<Inspecting>) => {
    store.setState(({ inspecting }) => ({ inspecting: { ...inspecting, ...change } }));
    await settled();
  };
  const moveTo = async (next: number) => {
    distance = next;
    store.setState(({ restedFrames }) => ({ restedFrames: restedFrames + 1 }));
    await settled();
  };
  /** Other edits as they are offered, the newest first. */
  const offered = () => store.getState().keptVersions?.versions.map(({ edits }) => edits) ?? [];
  const bringBack = async (edits: string) => {
    store
      .getState()
      .keptVersions!.versions.find((version) => version.edits === edits)!
      .bringBack();
    await settled();
  };
  const shown = () => describeEdits(store.getState().inspecting);
  const undo = async () => {
    undoEdit(store);
    await settled();
  };
  return {
    store,
    camera,
    open,
    edit,
    moveTo,
    stop,
    offered,
    bringBack,
    shown,
    undo,
    distance: () => distance,
  };
}

const kept = () => [...records.values()].map(({ work }) => work.edits).filter((edits) => edits !== '');

const textOf = (store: ViewerStore) => {
  const { notice } = store.getState();
  return typeof notice === 'string' ? notice : notice?.text;
};
/** As many removed splats, from row 0. */
const removing = (count: number, key: number) => ({
  selecting: {
    ...NOTHING_INSPECTED.selecting,
    removed: new Map([[`${key}/0`, Uint32Array.of(2 ** count - 1)]]),
  },
});

/** A visit that removes splats. */
async function visit(name: string, count: number, kind?: string): Promise<Tab> {
  const tab = newTab();
  const { open, edit, stop } = load(tab);
  const key = await open(name, kind);
  await edit(removing(count, key));
  stop();
  return tab;
}

it('a scene comes back after a reload with its view and its edits, which one step undoes', async () => {
  const tab = newTab();
  const first = load(tab);
  const key = await first.open('a.ply');
  await first.edit({ crop: CROP, ...removing(3, key) });
  await first.moveTo(7);
  first.stop();

  const again = load(tab);
  const next = await again.open('a.ply');
  expect(textOf(again.store)).toBe('a.ply is as you left it, with a crop and 3 removed splats.');
  const { crop, selecting } = again.store.getState().inspecting;
  expect([crop, [...selecting.removed.keys()], again.distance()]).toEqual([CROP, [`${next}/0`], 7]);
  expect(again.offered()).toEqual([]);
  await again.undo();
  expect(again.shown()).toBe('');
  expect(again.offered()).toEqual(['a crop and 3 removed splats']);
});

it('a scene of which nothing was kept is as it is, also after a reload that shows another one first', async () => {
  const tab = await visit('a.ply', 3);
  const { open, store, shown } = load(tab);
  await open('Still life', 'builtin');
  expect([textOf(store), shown()]).toEqual([undefined, '']);
  await open('a.ply');
  expect(shown()).toBe('3 removed splats');
});

/**
 * @fault Order: kept edits are not brought back, and the scene is edited anew
 * @consequence Both versions are kept, and either can be chosen, on this visit and on later ones.
 */
it('edits of another visit are offered, and outlive new ones', async () => {
  await visit('a.ply', 5);
  const second = load();
  const key = await second.open('a.ply');
  await second.moveTo(9);
  expect([second.shown(), second.offered()]).toEqual(['', ['5 removed splats']]);
  await second.edit(removing(2, key));
  expect(second.offered()).toEqual(['5 removed splats']);
  second.stop();

  const third = load();
  await third.open('a.ply');
  expect(third.offered()).toEqual(['2 removed splats', '5 removed splats']);
  await third.bringBack('5 removed splats');
  expect([third.shown(), third.offered()]).toEqual(['5 removed splats', ['2 removed splats']]);
  await third.bringBack('2 removed splats');
  expect([third.shown(), third.offered()]).toEqual(['2 removed splats', ['5 removed splats']]);
  await third.undo();
  expect([third.shown(), third.offered()]).toEqual(['5 removed splats', ['2 removed splats']]);
  await third.undo();
  expect([third.shown(), third.offered()]).toEqual(['', ['2 removed splats', '5 removed splats']]);
  third.stop();
  const fourth = load();
  await fourth.open('a.ply');
  expect(fourth.offered()).toEqual(['2 removed splats', '5 removed splats']);
});

it('new edits stay when older ones are brought back in their place', async () => {
  await visit('a.ply', 5);
  const second = load();
  const key = await second.open('a.ply');
  await second.edit(removing(2, key));
  await second.bringBack('5 removed splats');
  expect([second.shown(), second.offered()]).toEqual(['5 removed splats', ['2 removed splats']]);
  second.stop();
  const third = load();
  await third.open('a.ply');
  expect(third.offered()).toEqual(['5 removed splats', '2 removed splats']);
});

it('edits that went on from others are offered in their place', async () => {
  const tab = await visit('a.ply', 5);
  for (const count of [6, 7]) {
    const page = load(tab);
    const key = await page.open('a.ply');
    await page.edit(removing(count, key));
    page.stop();
  }
  const other = load();
  await other.open('a.ply');
  expect(other.offered()).toEqual(['7 removed splats']);
  // Reloads leave nothing behind but the last version and the one before.
  expect(records.size).toBeLessThanOrEqual(2);
});

/**
 * @fault Order: two tabs edit the same file and are loaded again, or one is a copy of the other
 * @consequence Each has its own edits, and says that the other one edits the file, too.
 */
it('tabs on one file have edits of their own, and tell of each other', async () => {
  const [tabA, tabB] = [newTab(), newTab()];
  const a = load(tabA);
  await a.edit(removing(3, await a.open('a.ply', 'url')));
  const b = load(tabB);
  const key = await b.open('a.ply', 'url');
  expect(b.store.getState().keptVersions).toMatchObject({
    isElsewhere: true,
    versions: [{ edits: '3 removed splats', isElsewhere: true }],
  });
  // Nor does Ctrl+Z bring the other tab's edits.
  expect(b.store.getState().leftScene).toBeNull();
  expect(a.store.getState().keptVersions).toBeNull();
  await b.edit(removing(5, key));
  expect([a.offered(), b.offered()]).toEqual([['5 removed splats'], ['3 removed splats']]);
  a.stop();
  const again = load(tabA);
  await again.open('a.ply', 'url');
  expect(again.shown()).toBe('3 removed splats');
  expect(again.store.getState().keptVersions).toMatchObject({ isElsewhere: true });

  const tabC = { ...tabA };
  const copy = load(tabC);
  const keyOfCopy = await copy.open('a.ply', 'url');
  expect(copy.shown()).toBe('3 removed splats');
  expect(copy.store.getState().keptVersions).toMatchObject({ isElsewhere: true });
  await copy.edit(removing(8, keyOfCopy));
  for (const page of [again, b, copy]) page.stop();
  for (const [tab, edits] of [
    [tabA, 3],
    [tabB, 5],
    [tabC, 8],
  ] as const) {
    const page = load(tab);
    await page.open('a.ply', 'url');
    expect(page.shown()).toBe(`${edits} removed splats`);
    page.stop();
  }
  const { offered, open } = load();
  await open('a.ply', 'url');
  expect(new Set(offered())).toEqual(new Set(['3 removed splats', '5 removed splats', '8 removed splats']));
});

it('edits that were taken from an open tab do not stand for what that tab does later', async () => {
  const a = load();
  const keyOfA = await a.open('a.ply');
  await a.edit(removing(3, keyOfA));
  const b = load();
  await b.open('a.ply');
  await b.bringBack('3 removed splats');
  await a.edit(removing(4, keyOfA));
  a.stop();
  b.stop();
  const { offered, open } = load();
  await open('a.ply');
  expect(new Set(offered())).toEqual(new Set(['3 removed splats', '4 removed splats']));
});

it('the same file that is opened anew leaves its edits as a version', async () => {
  const page = load();
  await page.edit(removing(3, await page.open('a.ply')));
  await page.open('a.ply');
  expect([page.shown(), page.offered(), kept()]).toEqual(['', ['3 removed splats'], ['3 removed splats']]);
});

it('edits that came back with their scene are not offered again', async () => {
  const { store, open, edit, offered } = load();
  const key = await open('a.ply');
  await edit({ crop: CROP });
  await open('b.ply');
  const parts = open('a.ply', 'file', 100, key);
  store.setState({ inspecting: { ...NOTHING_INSPECTED, crop: CROP } });
  await parts;
  expect(store.getState()).toMatchObject({ leftScene: null, notice: null });
  expect(offered()).toEqual([]);
});

it('another scene of the same name gets none of it', async () => {
  await visit('a.ply', 1);
  const second = load();
  await second.open('b.ply');
  expect(second.store.getState()).toMatchObject({ leftScene: null, notice: null, keptVersions: null });
});

it('rows that the file has no more are told, and its edits stay as they are', async () => {
  const tab = await visit('https://example.com/a.ply', 20, 'url');
  const { store, open, shown, offered } = load(tab);
  await open('https://example.com/a.ply', 'url', 10);
  expect(shown()).toBe('');
  expect(store.getState().failure).toMatchObject({
    title: '20 removed splats cannot be brought back',
    message: 'The last row of removed 0/0 is 19, but must be below 10.',
  });
  expect(offered()).toEqual(['20 removed splats']);
});

it('what is undone is forgotten', async () => {
  const { open, edit } = load();
  await open('https://example.com/a.ply', 'url');
  await edit({ crop: CROP });
  expect(records.size).toBe(1);
  await edit({ crop: null });
  expect(records.size).toBe(0);
});

/**
 * @fault Saved files: the browser has no room for edits
 * @consequence It is said from the first edit on until there is room, and the tab asks before it is closed.
 */
it('the tab asks before it is closed where the browser has no room for edits', async () => {
  const isAsked = () => !page.dispatchEvent(new Event('beforeunload', { cancelable: true }));
  failure = new DOMException('Full.', 'QuotaExceededError');
  const { store, open, edit, stop } = load();
  const unkept = () => [...store.getState().unkept];
  await open('a.ply');
  expect([isAsked(), unkept()]).toEqual([false, []]);
  await edit({ crop: CROP });
  expect([isAsked(), unkept()]).toEqual([true, [['edits', failure]]]);
  await vi.advanceTimersByTimeAsync(60_000);
  expect(unkept()).toHaveLength(1);
  await edit({ crop: null });
  expect([isAsked(), unkept()]).toEqual([false, []]);
  await edit({ crop: CROP });
  failure = null;
  await edit({ crop: { ...CROP, keep: 'outside' } });
  expect([isAsked(), unkept(), kept()]).toEqual([false, [], ['a crop']]);
  stop();
});

it('an edit is kept at once if the page is left', async () => {
  const { store, open, stop } = load();
  await open('a.ply');
  store.setState(({ inspecting }) => ({ inspecting: { ...inspecting, crop: CROP } }));
  page.dispatchEvent(new Event('beforeunload', { cancelable: true }));
  await vi.advanceTimersByTimeAsync(0);
  expect(kept()).toEqual(['a crop']);
  stop();
});
