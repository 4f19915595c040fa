import { beforeEach, expect, it, vi } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import { type Inspecting, NOTHING_INSPECTED } from '../state/inspecting.ts';
import { undoEdit } from '../state/make-edit.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import { keepWork, type WorkRecord, type WorkStore } from './keep-work.ts';

const CROP = { min: [0, 0, 0], max: [1, 1, 1], keep: 'inside' } as const;
const CAMERA = { pose: FRONT, fovDegrees: 50, isOrthographic: false, isFlipped: false, isZUp: false };

/** What the browser has, over several loads of the page. */
let records: Map<string, WorkRecord>;
let sceneOfTab: string | null;
let canWrite: boolean;
let page: EventTarget;

beforeEach(() => {
  vi.useFakeTimers();
  records = new Map();
  sceneOfTab = null;
  canWrite = true;
  page = new EventTarget();
  vi.stubGlobal('addEventListener', page.addEventListener.bind(page));
  vi.stubGlobal('removeEventListener', page.removeEventListener.bind(page));
  return () => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  };
});

/** All timers have run, and code that was asked for has come. */
async function settled(): Promise<void> {
  await vi.advanceTimersByTimeAsync(1000);
  await vi.dynamicImportSettled();
  await vi.advanceTimersByTimeAsync(1000);
}

/** A page that shows nothing yet. */
function load() {
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
  const kept: WorkStore = {
    read: async (key) => records.get(key),
    write: async (key, work) => {
      if (!canWrite) throw new Error('no room');
      records.set(key, work);
    },
    clear: async (key) => records.delete(key),
    get sceneOfTab() {
      return sceneOfTab;
    },
    set sceneOfTab(key) {
      sceneOfTab = key;
    },
  };
  const stop = keepWork({ store, viewer } as unknown as PanelProps, kept);
  const open = async (name: string, key: number, kind = 'file') => {
    newest.parts = [{ key, contentKey: name, source: { kind, name }, look: {}, loaded: {} }];
    store.setState({ scene: { title: name } as never, inspecting: NOTHING_INSPECTED, load: null });
    await settled();
  };
  const edit = async (change: Partial<Inspecting>) => {
    store.setState(({ inspecting }) => ({ inspecting: { ...inspecting, ...change } }));
    await vi.advanceTimersByTimeAsync(1000);
  };
  const moveTo = async (next: number) => {
    distance = next;
    store.setState(({ restedFrames }) => ({ restedFrames: restedFrames + 1 }));
    await vi.advanceTimersByTimeAsync(1000);
  };
  return { store, camera, open, edit, moveTo, stop, distance: () => distance };
}

const textOf = (store: ViewerStore) => {
  const { notice } = store.getState();
  return typeof notice === 'string' ? notice : notice?.text;
};
const removing = (key: string) => ({
  ...NOTHING_INSPECTED.selecting,
  removed: new Map([[key, Uint32Array.of(0b111)]]),
});

it('a scene comes back after a reload with its view and its edits, which one step undoes', async () => {
  const first = load();
  await first.open('a.ply', 3);
  await first.edit({ crop: CROP, selecting: removing('3/0') });
  await first.moveTo(7);
  first.stop();

  const again = load();
  await again.open('Still life', 1, 'builtin');
  expect(textOf(again.store)).toBeUndefined();
  sceneOfTab = 'a.ply';
  again.stop();

  const third = load();
  await third.open('a.ply', 1);
  expect(textOf(third.store)).toBe('a.ply is as you left it, with a crop and 3 removed splats.');
  const { crop, selecting } = third.store.getState().inspecting;
  expect([crop, [...selecting.removed.keys()], third.distance()]).toEqual([CROP, ['1/0'], 7]);
  undoEdit(third.store);
  expect(third.store.getState().inspecting.selecting.removed.size).toBe(0);
});

it('edits of another visit are offered, and are not lost before they are asked for', async () => {
  const first = load();
  await first.open('a.ply', 1);
  await first.edit({ crop: CROP });
  first.stop();
  sceneOfTab = null;

  const second = load();
  await second.open('a.ply', 2);
  await second.moveTo(9);
  expect(second.store.getState().inspecting.crop).toBeNull();
  expect(textOf(second.store)).toBe('a.ply had a crop when it was open last.');
  expect(records.get('a.ply')?.edits).toBe('a crop');
  second.store.getState().leftScene?.bringBack();
  await settled();
  expect(second.store.getState()).toMatchObject({ leftScene: null, inspecting: { crop: CROP } });
});

it('edits that came back with their scene are not offered again', async () => {
  const { store, open, edit } = load();
  await open('a.ply', 1);
  await edit({ crop: CROP });
  await open('b.ply', 2);
  const parts = open('a.ply', 1);
  store.setState({ inspecting: { ...NOTHING_INSPECTED, crop: CROP } });
  await parts;
  expect(store.getState()).toMatchObject({ leftScene: null, notice: null });
});

it('another scene of the same name gets none of it', async () => {
  const first = load();
  await first.open('a.ply', 1);
  await first.edit({ crop: CROP });
  first.stop();
  const second = load();
  await second.open('b.ply', 1);
  expect(second.store.getState()).toMatchObject({ leftScene: null, notice: null });
});

it('what is undone is forgotten', async () => {
  const { open, edit } = load();
  await open('https://example.com/a.ply', 1, 'url');
  await edit({ crop: CROP });
  expect(records.size).toBe(1);
  await edit({ crop: null });
  expect(records.size).toBe(0);
});

it('the tab asks before it is closed where the browser has no room for edits', async () => {
  const isAsked = () => !page.dispatchEvent(new Event('beforeunload', { cancelable: true }));
  canWrite = false;
  const { open, edit, stop } = load();
  await open('a.ply', 1);
  expect(isAsked()).toBe(false);
  await edit({ crop: CROP });
  expect(isAsked()).toBe(true);
  await edit({ crop: null });
  expect(isAsked()).toBe(false);
  stop();
});
