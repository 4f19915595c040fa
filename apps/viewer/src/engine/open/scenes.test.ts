import {
  type CloudInstance,
  type FrameSceneOptions,
  frameScene,
  type SceneFraming,
  type SplatCloud,
  SplatFileError,
} from '@websplatter/core';
import { tint } from '@websplatter/core/effects';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ViewCamera } from '../../camera/view-camera.ts';
import { NO_EFFECTS } from '../../state/effects.ts';
import { type Inspecting, NOTHING_INSPECTED } from '../../state/inspecting.ts';
import { redoEdit, undoEdit } from '../../state/make-edit.ts';
import { createViewerStore, type ViewerStore } from '../../state/store.ts';
import './failure-report.ts';
import type { Session } from '../show/session.ts';
import { loadScene } from './load-scene.ts';
import type { SceneSource } from './scene-source.ts';
import { Scenes } from './scenes.ts';
import type { LoadedScene, LoadSceneOptions } from './shown-scene.ts';

vi.mock('./load-scene.ts', () => ({ loadScene: vi.fn() }));
vi.mock('./content-key.ts', () => ({ contentKeyOf: async () => 'key' }));
vi.mock(import('@websplatter/core'), async (original) => ({ ...(await original()), frameScene: vi.fn() }));

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
const requests = { requestPrecisions: () => {}, requestFrame: () => {} };

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
  vi.mocked(frameScene).mockImplementation(async (clouds) => framingOf(clouds));
  store = createViewerStore();
  store.setState({ widthPx: 300, heightPx: 200 });
  camera = new ViewCamera(store, { onChange: () => {}, isMotionReduced: () => true });
  sessions.recover.mockReset();
  scenes = new Scenes({ store, sessions, camera, addressed: {}, ...requests });
});
afterEach(() => {
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

/** A scene of one cloud, `radius` around its origin. */
function sceneOf(radius = 1): LoadedScene {
  const bounds = { min: [-radius, -radius, -radius], max: [radius, radius, radius] };
  const facts = { declaredShDegree: 0 };
  const cloud = {
    ...{ count: 5, bounds, robustBounds: bounds, dropped: {}, shDegree: 0, facts },
    destroy: vi.fn(),
  };
  const clouds = [{ cloud: cloud as unknown as SplatCloud }];
  return { clouds, firstView: null, ownCameras: null, about: null, isUpsideDown: false };
}

/** Three of the largest radius away. */
function framingOf(clouds: readonly CloudInstance[], change: Partial<SceneFraming> = {}): SceneFraming {
  const radius = Math.max(...clouds.map(({ cloud }) => cloud.robustBounds.max[0]));
  return {
    kind: 'object',
    position: [0, 0, 3 * radius],
    target: [0, 0, 0],
    up: [0, 1, 0],
    fovYDegrees: 50,
    center: [0, 0, 0],
    radius,
    groundHeight: null,
    confidence: { up: 1, kind: 1 },
    ...change,
  };
}

interface Framing {
  readonly radius: number;
  readonly options: FrameSceneOptions;
  readonly resolve: (change?: Partial<SceneFraming>) => void;
  readonly reject: (error: Error) => void;
}

/** Framings are answered by the test from now on. */
function holdFramings(): Framing[] {
  const held: Framing[] = [];
  vi.mocked(frameScene).mockImplementation(
    (clouds, options = {}) =>
      new Promise((resolve, reject) => {
        options.signal?.addEventListener('abort', () => reject(options.signal?.reason));
        held.push({
          radius: framingOf(clouds).radius,
          options,
          resolve: (change) => resolve(framingOf(clouds, change)),
          reject,
        });
      }),
  );
  return held;
}

/** Several turns: code that is imported on demand arrives later than promises. */
async function settled(): Promise<void> {
  for (let turn = 0; turn < 8; turn++) await new Promise<void>((resolve) => setImmediate(resolve));
}

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

/**
 * @fault GPU memory: a file is too large for the viewer's settings
 * @consequence the scene is shown coarser, and a notice says how
 */
it('says so where a scene is shown coarser than it was wanted', async () => {
  const scene = sceneOf();
  const wanted = { geometryPrecision: 'packed', shPrecision: 'f16', shDegree: 3 };
  const fit = { wanted, taken: { ...wanted, shPrecision: 'u8' }, wantedBytes: 2e9, takenBytes: 1e9, why: '' };
  Object.assign(scene.clouds[0].cloud, { fit });
  await startSession();
  await loaded(scene);
  await expect.poll(() => store.getState().notice).toContain('shown with u8 harmonics');
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
    expect(scenes.drawable).toMatchObject({ parts: [{ source: a }], session: sessions.current });
    expect(camera.controls.pose.distance).toBe(7);
  });

  /**
   * @fault Devices and engines: a scene that the viewer opens fails, or is cancelled
   * @consequence the last scene comes back, with its camera; if that fails too, the built-in scene
   */
  it('opens what was being opened, and what was shown where that fails or is cancelled', async () => {
    for (const end of [failed, calledOff]) {
      await show(a);
      camera.controls.setPose({ ...camera.controls.pose, distance: 7 });
      scenes.open(b);
      await settled();
      // A part of it is shown, from elsewhere.
      newestLoad().options.onPreview(sceneOf(50));
      await settled();
      expect(camera.controls.pose.distance).toBe(150);
      loseSession();
      expect(store.getState().scene?.title).toBe('a.ply');
      await startSession();
      newestLoad().options.onPreview(sceneOf(50));
      await settled();
      await end();
      expect(openedKinds()).toEqual(['b.ply', 'b.ply', 'a.ply']);
      await loaded();
      expect(scenes.drawable).toMatchObject({ parts: [{ source: a }], session: sessions.current });
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

  it('opens nothing else where the page has nothing but the picture', async () => {
    store.setState({ hasInterface: false });
    scenes.open(b);
    await startSession();
    await failed();
    expect(openedKinds()).toEqual(['b.ply']);
    expect(store.getState()).toMatchObject({ scene: null, load: null, failure: { isFault: true } });
  });

  /**
   * @fault Devices and engines: a file is dropped while there is no GPU
   * @consequence the GPU is asked for at once, and the file opened
   */
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

  /**
   * @fault Devices and engines: a scene takes the GPU down whenever it is opened
   * @consequence a button opens a small scene instead
   */
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
    expect(scenes.drawable).toMatchObject({
      parts: [{ source: newestLoad().source }],
      session: sessions.current,
    });
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
  expect(store.getState().failure?.title).toBe('Refused, as it should be');
  expect(loads).toHaveLength(2);
});

describe('The first view', () => {
  let framings: Framing[];

  beforeEach(async () => {
    await startSession();
    await loaded();
    store.setState({ notice: null });
    framings = holdFramings();
    scenes.open(a);
    await settled();
  });
  const title = () => store.getState().scene?.title;

  it('is found before a scene is shown, for the shape of the image', async () => {
    await loaded(sceneOf(5));
    expect(title()).toBe('Still life');
    const [{ options, resolve }] = framings;
    expect(options).toMatchObject({ aspect: 1.5, fovYDegrees: expect.closeTo(50) });
    expect(options.up ?? options.kind).toBeUndefined();
    resolve({ up: [0, 0, -1], position: [0, 20, 0] });
    await settled();
    expect(title()).toBe('a.ply');
    expect(camera.controls.pose).toMatchObject({ distance: 20, up: [0, 0, 1] });
    expect(store.getState()).toMatchObject({ isFlipped: true, isZUp: true, load: null, notice: null });
    expect(camera.subjectRadius).toBe(5);
  });

  it('is the scene’s own, or that of its cameras, which need no other', async () => {
    const firstView = { position: [0, 0, 9], target: [0, 0, 0], up: [0, 1, 0] } as const;
    await loaded({ ...sceneOf(), firstView: { ...firstView, fovYDegrees: 50, near: 1, far: 99 } });
    expect(camera.controls.pose.distance).toBe(9);
    expect(framings).toHaveLength(0);
  });

  it('is that of the first preview, and then of all of the scene', async () => {
    newestLoad().options.onPreview(sceneOf(1));
    newestLoad().options.onPreview(sceneOf(2));
    expect(title()).toBe('Still life');
    expect(framings).toHaveLength(1);
    framings[0].resolve();
    await settled();
    // The newest is shown, by what was found for the first.
    expect(scenes.drawable?.sphere.radius).toBeCloseTo(2 * Math.sqrt(3));
    expect(camera.controls.pose.distance).toBe(3);
    newestLoad().options.onPreview(sceneOf(3));
    await loaded(sceneOf(4));
    expect(framings.map(({ radius }) => radius)).toEqual([1, 4]);
    expect(title()).toBe('a.ply');
    // Until then the picture does not count as being at rest.
    expect(scenes.isPartial).toBe(true);
    expect(camera.controls.pose.distance).toBe(3);
    framings[1].resolve();
    await settled();
    expect(camera.controls.pose.distance).toBe(12);
    expect(scenes.isPartial).toBe(false);
  });

  it('leaves a view that was moved meanwhile', async () => {
    newestLoad().options.onPreview(sceneOf(1));
    framings[0].resolve();
    await settled();
    camera.controls.moveTo({ ...camera.controls.pose, distance: 7 });
    await loaded(sceneOf(4));
    framings[1].resolve();
    await settled();
    expect(camera.controls.pose.distance).toBe(7);
    expect(camera.controls.home.distance).toBe(12);
  });

  it('is found for the next preview where one has given its splats away', async () => {
    const first = sceneOf(1);
    newestLoad().options.onPreview(first);
    newestLoad().options.onPreview(sceneOf(2));
    Object.assign(first.clouds[0].cloud, { isDestroyed: true });
    framings[0].reject(new Error('destroyed'));
    await settled();
    expect(title()).toBe('Still life');
    framings[1].resolve();
    await settled();
    expect(camera.controls.pose.distance).toBe(6);
    expect(store.getState().notice).toBeNull();
  });

  it('is that of the whole scene where the last preview is not known yet, and comes once', async () => {
    newestLoad().options.onPreview(sceneOf(1));
    await loaded(sceneOf(4));
    expect(framings.map(({ radius }) => radius)).toEqual([1, 4]);
    expect(framings[0].options.signal?.aborted).toBe(true);
    framings[1].resolve();
    await settled();
    expect(camera.controls.pose.distance).toBe(12);
    expect(scenes).toMatchObject({ isPartial: false });
    expect(framings).toHaveLength(2);
  });

  /**
   * @fault Arguments: no first view of a scene can be found, as when its worker dies
   * @consequence the whole scene, by its bounds, and a notice with the reason
   */
  it('shows all of the scene where none can be found, and says why', async () => {
    await loaded(sceneOf(5));
    framings[0].reject(new Error('The worker died.'));
    await settled();
    expect(title()).toBe('a.ply');
    expect(camera.controls.pose.distance).toBeGreaterThan(10);
    expect(store.getState().notice).toContain('The worker died.');
  });

  it('is not looked for any more where another scene is opened, whose splats are freed', async () => {
    const scene = sceneOf(5);
    await loaded(scene);
    scenes.open(b);
    await settled();
    expect(framings[0].options.signal?.aborted).toBe(true);
    expect(scene.clouds[0].cloud.destroy).toHaveBeenCalled();
    expect(title()).toBe('Still life');
    await loaded(sceneOf(2));
    framings[1].resolve();
    await settled();
    expect(title()).toBe('b.ply');
    expect(store.getState().notice).toBeNull();
  });

  it('tells what is uncertain, and offers the other', async () => {
    await loaded(sceneOf(5));
    framings[0].resolve({ confidence: { up: 0.3, kind: 0.4 } });
    await expect
      .poll(() => store.getState().notice)
      .toMatchObject({
        offers: [{ command: 'inside' }, { command: 'flip' }],
      });
    void scenes.lookFrom('enclosed');
    expect(framings[1].options).toMatchObject({ kind: 'enclosed', up: [0, 1, 0] });
    framings[1].resolve({ kind: 'enclosed', position: [0, 0, 1] });
    await settled();
    expect(camera.controls.pose.distance).toBe(1);
    expect(camera.controls.isHome).toBe(true);
  });
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
      ...requests,
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

describe('effects that panels ask for, and inspections', () => {
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

  it('come back with it where another scene is cancelled that is there in part', async () => {
    await show(a);
    store.setState({ requested, inspecting });
    scenes.open(b);
    await settled();
    newestLoad().options.onPreview(sceneOf());
    await settled();
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

describe('Several files', () => {
  /** Waits for the load of `source`; code that stands files beside others comes first. */
  const whenAsked = (source: SceneSource) => expect.poll(() => newestLoad()?.source).toBe(source);
  const titles = () => store.getState().scene?.parts.map(({ title }) => title);
  const keyOf = (title: string) => store.getState().scene!.parts.find((part) => part.title === title)!.key;

  /** Opens `sources` in a running session, each `radius` large. */
  async function openAll(sources: readonly SceneSource[], radius = 1): Promise<void> {
    scenes.open(...sources);
    for (const source of sources) {
      await whenAsked(source);
      await loaded(sceneOf(radius));
    }
  }

  beforeEach(async () => {
    await startSession();
    await loaded();
    loads.length = 0;
  });

  it('are opened one after another, and framed together once all are there', async () => {
    scenes.open(a, b);
    await settled();
    expect(store.getState()).toMatchObject({ load: { title: 'a.ply' }, waiting: [{ title: 'b.ply' }] });
    await loaded();
    await whenAsked(b);
    expect(titles()).toEqual(['a.ply']);
    expect(store.getState()).toMatchObject({ load: { title: 'b.ply' }, waiting: [] });
    expect(camera.controls.pose.distance).toBe(3);
    newestLoad().options.onPreview(sceneOf(20));
    expect(titles()).toEqual(['a.ply', 'b.ply']);
    expect(scenes.isPartial).toBe(true);
    expect(camera.controls.pose.distance).toBe(3);
    await loaded(sceneOf(20));
    expect(scenes.isPartial).toBe(false);
    expect(camera.controls.pose.distance).toBe(60);
    expect(store.getState()).toMatchObject({
      load: null,
      scene: { title: 'a.ply and b.ply', clouds: 2, splats: 10, isUpsideDown: false },
    });
    expect(scenes.newest?.clouds).toHaveLength(2);
  });

  it('join what is shown, and leave the view and home; the key F frames all of them', async () => {
    await openAll([a]);
    const { pose } = camera.controls;
    scenes.add(b);
    await whenAsked(b);
    newestLoad().options.onPreview(sceneOf(20));
    await loaded(sceneOf(20));
    expect(titles()).toEqual(['a.ply', 'b.ply']);
    expect(camera.controls.pose).toEqual(pose);
    expect(camera.controls.isHome).toBe(true);
    await scenes.frameAll();
    expect(camera.controls.pose.distance).toBe(60);
    expect(camera.controls.home).toEqual(pose);
    const [first] = scenes.newest!.clouds;
    expect(scenes.takeReplaced()).not.toContain(first.cloud);
  });

  /**
   * @fault Files: some of several files in the viewer cannot be opened
   * @consequence the others are shown, with a reason for each failure
   */
  it('without those that fail, of which all are told', async () => {
    scenes.open(a, b, c);
    await whenAsked(a);
    await failed();
    await whenAsked(b);
    await failed();
    // The first that can be opened replaces the former scene.
    expect(titles()).toEqual(['Still life']);
    await whenAsked(c);
    await loaded();
    expect(titles()).toEqual(['c.ply']);
    expect(store.getState().failure).toMatchObject({ title: '2 files cannot be opened' });
    expect(store.getState().failure?.message).toContain('a.ply cannot be shown: offline');
  });

  it('can be cancelled one by one', async () => {
    scenes.open(a, b, c);
    await whenAsked(a);
    await loaded();
    expect(scenes.cancelled).toEqual([]);
    await whenAsked(b);
    newestLoad().options.onPreview(sceneOf(20));
    const [waiting] = store.getState().waiting;
    scenes.remove(waiting.key);
    expect(store.getState().waiting).toEqual([]);
    await calledOff();
    expect(titles()).toEqual(['a.ply']);
    expect(store.getState()).toMatchObject({ load: null, notice: 'Opening b.ply was cancelled.' });
  });

  it('of the address are known once they are not opened after all', async () => {
    const [first, second, third] = ['a', 'b', 'c'].map((name) => `https://example.org/${name}.ply`);
    const hrefs = () => scenes.cancelled.map((source) => source.kind === 'url' && source.url.href);
    loseSession();
    scenes = new Scenes({
      ...{ store, sessions, camera, ...requests },
      addressed: { addresses: [first, second, third] },
    });
    await startSession();
    scenes.remove(store.getState().waiting[0].key);
    expect(hrefs()).toEqual([second]);
    scenes.cancelLoad();
    expect(hrefs()).toEqual([second, first]);
    await settled();
    scenes.open(a);
    expect(hrefs()).toEqual([second, first, third]);
    scenes.cancelLoad();
    expect(hrefs()).toHaveLength(3);
  });

  it('can be drawn otherwise while they arrive, and cancelled there', async () => {
    await openAll([a]);
    scenes.add(b);
    await whenAsked(b);
    newestLoad().options.onPreview(sceneOf());
    scenes.setLook(keyOf('b.ply'), { opacity: 0.5 });
    scenes.setLook(keyOf('a.ply'), { isHidden: true });
    expect(scenes.drawable?.clouds).toMatchObject([{ opacity: 0.5 }]);
    newestLoad().options.onPreview(sceneOf());
    await loaded();
    expect(scenes.newest?.clouds).toMatchObject([{ opacity: 0.5 }]);
    scenes.add(c);
    await whenAsked(c);
    newestLoad().options.onPreview(sceneOf());
    scenes.remove(keyOf('c.ply'));
    await settled();
    expect(titles()).toEqual(['a.ply', 'b.ply']);
  });

  /**
   * @fault Devices and engines: the device is lost while the viewer shows several files, or opens one more
   * @consequence all files are opened again, as they were drawn, with the same camera
   */
  it('are opened again as they were drawn after the device was lost', async () => {
    await openAll([a, b]);
    scenes.setLook(keyOf('b.ply'), { opacity: 0.5 });
    camera.controls.setPose({ ...camera.controls.pose, distance: 7 }, camera.controls.home);
    scenes.add(c);
    await whenAsked(c);
    loseSession();
    loads.length = 0;
    await startSession();
    for (const source of [a, b, c]) {
      await whenAsked(source);
      await loaded();
    }
    expect(titles()).toEqual(['a.ply', 'b.ply', 'c.ply']);
    expect(scenes.newest?.session).toBe(sessions.current);
    expect(scenes.newest?.parts.map(({ look }) => look.opacity)).toEqual([1, 0.5, 1]);
    expect(camera.controls.pose.distance).toBe(7);
  });

  it('keep their first view when they are opened again', async () => {
    await openAll([a, b]);
    loseSession();
    await startSession();
    for (const source of [a, b]) {
      await whenAsked(source);
      await loaded();
    }
    // A link need not tell where the camera is.
    expect(camera.first?.pose).toEqual(camera.controls.pose);
  });

  it('can be hidden, and left out but for the last', async () => {
    await openAll([a, b]);
    const clouds = scenes.newest!.clouds.map(({ cloud }) => cloud);
    const { id } = scenes.newest!;
    scenes.takeReplaced();
    scenes.setLook(keyOf('a.ply'), { isHidden: true });
    // A link must tell where the camera is.
    expect(camera.first).toBeNull();
    expect(scenes.newest).toMatchObject({ id, clouds: [{ cloud: clouds[1] }] });
    expect(store.getState().scene).toMatchObject({ clouds: 2, canSave: true });
    scenes.remove(keyOf('a.ply'));
    expect(titles()).toEqual(['b.ply']);
    expect(scenes.newest!.id).not.toBe(id);
    // Kept until a frame without it has been drawn.
    expect(scenes.takeReplaced()).toEqual([clouds[0]]);
    scenes.remove(keyOf('b.ply'));
    expect(titles()).toEqual(['b.ply']);
  });

  it('that cannot be drawn together are drawn as before the last of them', async () => {
    await openAll([a, b]);
    const [, second] = scenes.newest!.clouds;
    scenes.takeBack(new Error('no memory'));
    await settled();
    expect(titles()).toEqual(['a.ply']);
    expect(store.getState().failure?.title).toBe('b.ply cannot be shown');
    expect(second.cloud.destroy).toHaveBeenCalled();
  });

  /** Half a turn around x. */
  const HALF_TURN = [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1];

  /**
   * @fault Files: two files are opened together whose axes up differ, in formats that name none
   * @consequence each stands upright, as it does alone
   */
  it.each([
    ['as their formats say where their splats do not', true, { confidence: { up: 0.4, kind: 1 } }, HALF_TURN],
    ['as their splats say, whatever their formats say', false, { up: [0, -1, 0] as const }, HALF_TURN],
    ['in the same axes where both have the same up', true, {}, undefined],
    [
      'in the same axes where neither format nor splats tell',
      false,
      { confidence: { up: 0.4, kind: 1 } },
      undefined,
    ],
  ])('stand upright %s', async (_, isUpsideDown, found, matrix) => {
    await openAll([a]);
    vi.mocked(frameScene).mockImplementationOnce(async (clouds) => framingOf(clouds, found));
    scenes.add(b);
    await whenAsked(b);
    await loaded({ ...sceneOf(), isUpsideDown });
    const [first, second] = scenes.newest!.clouds;
    expect(first.modelMatrix).toBeUndefined();
    expect(second.modelMatrix && Array.from(second.modelMatrix)).toEqual(matrix);
  });

  it('are taken out by undo if they were added, and come back as they were', async () => {
    await openAll([a]);
    scenes.add(b);
    await whenAsked(b);
    await loaded();
    await expect.poll(() => store.getState().past.map(({ name }) => name)).toEqual(['addition of b.ply']);
    const [, { key }] = scenes.newest!.parts;
    scenes.setLook(key, { opacity: 0.5 });
    undoEdit(store);
    expect(titles()).toEqual(['a.ply']);
    redoEdit(store);
    await whenAsked(b);
    // Undo and redo go on while it is read again.
    expect(scenes.lookOf(key)?.opacity).toBe(0.5);
    scenes.setLook(key, { opacity: 0.25 });
    await loaded();
    expect(titles()).toEqual(['a.ply', 'b.ply']);
    expect(scenes.newest!.parts[1]).toMatchObject({ key, look: { opacity: 0.25 } });
    expect(store.getState().past).toHaveLength(1);
  });

  it('take the place of a hard case, which is shown alone', async () => {
    scenes.open({ kind: 'hard-case', name: 'far-origin' });
    await settled();
    await loaded();
    scenes.add(a);
    await whenAsked(a);
    await loaded();
    expect(titles()).toEqual(['a.ply']);
  });

  /**
   * @fault Arguments: the viewer's URL has an invalid place of a file
   * @consequence the file at its own place, and a notice
   */
  it('of a link are drawn as it says, and what it says wrongly is told', async () => {
    loseSession();
    loads.length = 0;
    scenes = new Scenes({
      ...{ store, sessions, camera, ...requests },
      addressed: { addresses: ['a.ply', 'b.ply'] },
      linkedLooks: ['opacity:0.25', 'move:1'],
    });
    await startSession();
    await expect.poll(() => loads).toHaveLength(1);
    await loaded();
    await expect.poll(() => loads).toHaveLength(2);
    await loaded();
    expect(scenes.newest?.parts.map(({ look }) => look.opacity)).toEqual([0.25, 1]);
    expect(store.getState().notice).toContain('move:1 is not three numbers');
  });
});

describe('A scene with edits that another one replaces', () => {
  const crop = { min: [0, 0, 0], max: [1, 1, 1], keep: 'inside' } as const;
  const edited: Inspecting = { ...NOTHING_INSPECTED, crop };

  async function replaceEdited(withPreview = false): Promise<void> {
    await show(a);
    store.setState({ inspecting: edited, requested: { ...NO_EFFECTS, text: 'fog' } });
    camera.controls.setPose({ ...camera.controls.pose, distance: 7 });
    scenes.open(b);
    await settled();
    if (withPreview) newestLoad().options.onPreview(sceneOf(20));
    await settled();
    await loaded(sceneOf(30));
  }

  for (const withPreview of [false, true])
    it(`is offered and comes back with them and its camera, ${withPreview ? 'after a preview' : 'at once'}`, async () => {
      await replaceEdited(withPreview);
      expect(store.getState()).toMatchObject({ leftScene: { title: 'a.ply' }, inspecting: { crop: null } });
      await expect
        .poll(() => store.getState().notice)
        .toEqual({
          text: 'a.ply had a crop.',
          offers: [{ label: 'Bring back', command: 'bring-back' }],
        });
      store.getState().leftScene?.bringBack();
      await settled();
      expect(openedKinds().at(-1)).toBe('a.ply');
      await loaded();
      expect(store.getState()).toMatchObject({
        scene: { title: 'a.ply' },
        leftScene: null,
        inspecting: { crop },
        requested: { text: 'fog' },
      });
      expect(camera.controls.pose.distance).toBe(7);
    });

  it('is offered again if it cannot be opened', async () => {
    await replaceEdited();
    store.getState().leftScene?.bringBack();
    await settled();
    await failed();
    expect(store.getState()).toMatchObject({ scene: { title: 'b.ply' }, leftScene: { title: 'a.ply' } });
  });

  it('is not offered without edits, or where files join it', async () => {
    await show(a);
    scenes.open(b);
    await settled();
    await loaded();
    expect(store.getState()).toMatchObject({ leftScene: null, notice: null });
    store.setState({ inspecting: edited });
    scenes.add(c);
    await settled();
    await loaded();
    expect(store.getState()).toMatchObject({ leftScene: null, notice: null, inspecting: { crop } });
    store.getState().leftScene?.bringBack();
    await settled();
    expect(store.getState().load).toBeNull();
  });
});
