import { type SplatCloud, SplatFileError } from '@websplatter/core';
import { tint } from '@websplatter/core/effects';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ViewCamera } from '../camera/view-camera.ts';
import type { Session } from '../session/session.ts';
import { type Inspecting, NOTHING_INSPECTED } from '../state/inspecting.ts';
import { NO_EFFECTS } from '../state/requested-effects.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import { type LoadedScene, type LoadSceneOptions, loadScene } from './load-scene.ts';
import type { SceneSource } from './scene-source.ts';
import { Scenes } from './scenes.ts';

vi.mock('./load-scene.ts', () => ({ loadScene: vi.fn(), destroyClouds: vi.fn() }));

interface Load {
  readonly source: SceneSource;
  readonly options: LoadSceneOptions;
  readonly resolve: (scene: LoadedScene) => void;
  readonly reject: (error: Error) => void;
}

const [a, b, c] = ['a.ply', 'b.ply', 'c.ply'].map(
  (name): SceneSource => ({ kind: 'file', name, source: new File([], name) }),
);

let store: ViewerStore;
let camera: ViewCamera;
let scenes: Scenes;
let loads: Load[];
const sessions = {
  current: null as Session | null,
  whenStarted: async () => sessions.current!,
  recover: vi.fn(),
};

beforeEach(() => {
  vi.stubGlobal('location', { href: 'https://example.org/' });
  vi.spyOn(console, 'error').mockImplementation(() => {});
  loads = [];
  vi.mocked(loadScene).mockImplementation(
    (_engine, source, options) =>
      new Promise((resolve, reject) => {
        options.signal.addEventListener('abort', () => reject(new Error('called off')));
        loads.push({ source, options, resolve, reject });
      }),
  );
  store = createViewerStore();
  store.setState({ widthPx: 300, heightPx: 200 });
  camera = new ViewCamera(store, { onChange: () => {}, isMotionReduced: () => true });
  sessions.recover.mockReset();
  scenes = new Scenes({ store, sessions, camera, addressed: {}, onClouds: () => {}, onShow: () => {} });
});
afterEach(() => {
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

/** A scene of one cloud, `radius` around its origin. */
function sceneOf(radius = 1): LoadedScene {
  const bounds = { min: [-radius, -radius, -radius], max: [radius, radius, radius] };
  const facts = { declaredShDegree: 0 };
  const cloud = { count: 5, bounds, robustBounds: bounds, dropped: {}, shDegree: 0, facts };
  const clouds = [{ cloud: cloud as unknown as SplatCloud }];
  return { clouds, firstView: null, ownCameras: null, about: null, isUpsideDown: false, isZUp: false };
}

const settled = () => new Promise<void>((resolve) => setImmediate(resolve));

async function startSession(): Promise<void> {
  const engine = { device: { adapterInfo: {} } };
  sessions.current = { engine } as unknown as Session;
  store.setState({ status: 'running' });
  scenes.openFirst(sessions.current);
  await settled();
}

function loseSession(status: 'starting' | 'lost' = 'starting'): void {
  sessions.current = null;
  store.setState({ status, load: null, failure: null });
  scenes.endSession();
}

const newestLoad = () => loads.at(-1)!;
const openedKinds = () => loads.map(({ source }) => (source.kind === 'file' ? source.name : source.kind));

/** Answers the newest load. */
async function loaded(scene = sceneOf()): Promise<void> {
  newestLoad().resolve(scene);
  await settled();
}

async function failed(): Promise<void> {
  newestLoad().reject(new Error('offline'));
  await settled();
}

async function calledOff(): Promise<void> {
  scenes.cancelLoad();
  await settled();
}

/** Shows `source` in a new session. */
async function show(source: SceneSource): Promise<void> {
  await startSession();
  scenes.open(source);
  await settled();
  await loaded();
  loads.length = 0;
}

it('says so where a scene is shown coarser than it was wanted', async () => {
  const scene = sceneOf();
  const wanted = { geometryPrecision: 'packed', shPrecision: 'f16', shDegree: 3 };
  const fit = { wanted, taken: { ...wanted, shPrecision: 'u8' }, wantedBytes: 2e9, takenBytes: 1e9, why: '' };
  Object.assign(scene.clouds[0].cloud, { fit });
  await startSession();
  await loaded(scene);
  expect(store.getState().notice).toContain('shown with u8 harmonics');
});

describe('After the device was lost', () => {
  it('opens the scene again that was shown, where the camera was', async () => {
    await show(a);
    camera.controls.setPose({ ...camera.controls.pose, distance: 7 });
    loseSession();
    expect(scenes.drawable?.session).not.toBe(sessions.current);
    await startSession();
    await loaded();
    expect(openedKinds()).toEqual(['a.ply']);
    expect(scenes.drawable).toMatchObject({ source: a, session: sessions.current });
    expect(camera.controls.pose.distance).toBe(7);
  });

  it('opens what was being opened, and what was shown where that fails or is called off', async () => {
    for (const end of [failed, calledOff]) {
      await show(a);
      camera.controls.setPose({ ...camera.controls.pose, distance: 7 });
      scenes.open(b);
      await settled();
      // A part of it is shown, from elsewhere.
      newestLoad().options.onPreview(sceneOf(50));
      expect(camera.controls.pose.distance).not.toBe(7);
      loseSession();
      expect(store.getState().scene?.title).toBe('a.ply');
      await startSession();
      newestLoad().options.onPreview(sceneOf(50));
      await end();
      expect(openedKinds()).toEqual(['b.ply', 'b.ply', 'a.ply']);
      await loaded();
      expect(scenes.drawable).toMatchObject({ source: a, session: sessions.current });
      expect(camera.controls.pose.distance).toBe(7);
      expect(store.getState()).toMatchObject({ load: null, scene: { title: 'a.ply' } });
    }
  });

  it('opens the built-in scene where neither can be opened any more, and says so where not even that', async () => {
    await show(a);
    scenes.open(b);
    loseSession();
    await startSession();
    await failed();
    await failed();
    expect(openedKinds().slice(-3)).toEqual(['b.ply', 'a.ply', 'builtin']);
    expect(store.getState().failure).not.toBeNull();
    await failed();
    expect(store.getState()).toMatchObject({ scene: null, load: null });
    expect(scenes.drawable).toBeNull();
    expect(openedKinds().at(-1)).toBe('builtin');
  });

  it('asks for the GPU at once to open a file that a person drops, in place of what was shown', async () => {
    await show(a);
    loseSession('lost');
    scenes.open(b);
    expect(sessions.recover).toHaveBeenCalledOnce();
    // Before there is a GPU.
    store.setState({ status: 'recovering' });
    scenes.open(c);
    expect(openedKinds()).toEqual([]);
    await startSession();
    expect(openedKinds()).toEqual(['c.ply']);
  });

  it('leaves a scene that takes the GPU down', async () => {
    await show(a);
    scenes.open(b);
    loseSession('lost');
    scenes.openSmallScene();
    expect(sessions.recover).toHaveBeenCalledOnce();
    expect(store.getState().scene).toBeNull();
    await startSession();
    expect(newestLoad().source).toMatchObject({ kind: 'builtin', scene: { name: 'still-life-small' } });
    await loaded();
    expect(scenes.drawable).toMatchObject({ source: newestLoad().source, session: sessions.current });
    loseSession();
    await startSession();
    expect(newestLoad().source.kind).toBe('builtin');
  });
});

it('shows a file that must be refused as a scene of its own, with its error', async () => {
  await startSession();
  scenes.open({ kind: 'hard-case', name: 'input-truncated' });
  await settled();
  const refusal = new SplatFileError('truncated', 'input-truncated', 'It ends.');
  await loaded({ ...sceneOf(), clouds: [], about: { topic: 'Input', text: 'It is cut off.' }, refusal });
  expect(store.getState().scene).toMatchObject({ title: 'input-truncated', clouds: 0, splats: 0 });
  expect(store.getState().failure?.title).toBe('The file is incomplete');
  expect(loads).toHaveLength(2);
});

describe('The camera of a link', () => {
  const linkedCamera = {
    pose: { target: [0, 0, 0], distance: 7, azimuth: 1, polar: 1, up: [0, 1, 0] },
    fovDegrees: 40,
    isOrthographic: false,
    cameraIndex: 0,
    isFlipped: false,
    isZUp: false,
  } as const;
  const scenesOf = (scene: string) =>
    new Scenes({
      store,
      sessions,
      camera,
      addressed: { scene },
      linkedCamera,
      onClouds: () => {},
      onShow: () => {},
    });

  it('looks at the scene of the link, and at no other', async () => {
    scenes = scenesOf('still-life-small');
    await startSession();
    await loaded();
    expect(camera.snapshot()).toMatchObject(linkedCamera);
    scenes.open(a);
    await settled();
    await loaded();
    expect(camera.snapshot().pose.distance).not.toBe(7);
  });

  it('does not look at what is shown because the scene of the link is not there', async () => {
    scenes = scenesOf('nowhere');
    await startSession();
    await loaded();
    expect(camera.snapshot().pose.distance).not.toBe(7);
  });
});

describe('effects that panels ask for, and what is inspected', () => {
  const requested = { ...NO_EFFECTS, effects: [tint([1, 0, 0])] };
  const inspecting: Inspecting = { ...NOTHING_INSPECTED, rulerStart: [1, 2, 3] };
  const kept = () => [store.getState().requested, store.getState().inspecting];

  it('end with the scene', async () => {
    await show(a);
    store.setState({ requested, inspecting });
    scenes.open(b);
    await settled();
    expect(kept()).toEqual([requested, inspecting]);
    await loaded();
    expect(kept()).toEqual([NO_EFFECTS, NOTHING_INSPECTED]);
  });

  it('come back with it where another scene is called off that is there in part', async () => {
    await show(a);
    store.setState({ requested, inspecting });
    scenes.open(b);
    await settled();
    newestLoad().options.onPreview(sceneOf());
    expect(kept()).toEqual([NO_EFFECTS, NOTHING_INSPECTED]);
    await calledOff();
    expect(kept()).toEqual([requested, inspecting]);
  });

  it('stay where the same scene is opened again', async () => {
    await show(a);
    store.setState({ requested, inspecting });
    loseSession();
    await startSession();
    await loaded();
    expect(kept()).toEqual([requested, inspecting]);
  });
});
