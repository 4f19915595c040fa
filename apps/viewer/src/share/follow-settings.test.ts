import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import type { Viewer } from '../engine/viewer.ts';
import type { SceneSummary } from '../state/scene.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import { followDroppedSettings, followSettings } from './follow-settings.ts';
import { readSceneSettings } from './scene-settings.ts';
import { settingsOfView } from './settings-of-view.ts';
import { writeSceneSettings } from './settings-section.tsx';

const SETTINGS = {
  version: 2,
  background: { color: [1, 0, 0] },
  cameras: [{ initial: { position: [0, 0, 5], target: [0, 0, 0], fov: 60 } }],
  animTracks: [],
  startMode: 'default',
};
const fileOf = (contents: unknown) => new File([JSON.stringify(contents)], 'settings.json');
const sceneOf = (title: string) => ({ title, isUpsideDown: true }) as SceneSummary;
const LOAD = { title: 'b.ply' } as never;

let store: ViewerStore;
const setLook = vi.fn();
const restore = vi.fn();
const viewer = { camera: { setLook, restore } } as unknown as Viewer;
const follow = (replaced: SceneSummary | null, contents: unknown = SETTINGS) =>
  followDroppedSettings(fileOf(contents), replaced, store, viewer);

beforeEach(() => {
  store = createViewerStore();
  vi.clearAllMocks();
});

afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

it('dropped settings show the scene on the screen as they say', async () => {
  store.setState({ scene: sceneOf('a.ply') });
  await follow(null);
  expect(setLook).toHaveBeenCalledWith({ background: '#ff0000' });
  expect(restore).toHaveBeenCalledOnce();
  expect(restore.mock.lastCall?.[0]).toMatchObject({ isFlipped: true, isOrthographic: false });
});

it('settings beside a scene wait until that is there in place of another', async () => {
  const replaced = sceneOf('a.ply');
  store.setState({ scene: replaced, load: LOAD });
  await follow(replaced);
  expect(restore).not.toHaveBeenCalled();
  store.setState({ scene: sceneOf('b.ply'), load: null });
  await Promise.resolve();
  expect(restore).toHaveBeenCalledOnce();
  store.setState({ scene: sceneOf('c.ply') });
  await Promise.resolve();
  expect(restore).toHaveBeenCalledOnce();
});

it('settings beside a scene that cannot be opened are those of no other one', async () => {
  const replaced = sceneOf('a.ply');
  store.setState({ scene: replaced, load: LOAD });
  await follow(replaced);
  store.setState({ load: null });
  // Or before the settings were read.
  await follow(replaced);
  store.setState({ scene: sceneOf('c.ply') });
  await Promise.resolve();
  expect(restore).not.toHaveBeenCalled();
});

it('a file that is no settings.json is told', async () => {
  await follow(null, { version: 7 });
  expect(store.getState().failure).toMatchObject({
    title: 'The settings cannot be used',
    message: expect.stringContaining('version'),
    advice: expect.stringContaining('Drop'),
  });
  expect(setLook).not.toHaveBeenCalled();
});

it('annotations are where they are in the file, and come back as they were', async () => {
  const { initial } = SETTINGS.cameras[0];
  const words = { title: 'Jug', text: 'Old.' };
  const annotations = [{ position: [1, 2, 3], ...words, extras: {}, camera: { initial } }];
  store.setState({ scene: sceneOf('a.ply'), widthPx: 300, heightPx: 200 });
  await follow(null, { ...SETTINGS, annotations });
  const { list } = store.getState().annotating;
  // SuperSplat turns the file around z.
  expect(list).toMatchObject([{ ...words, point: [-1, -2, 3], view: { isFlipped: true } }]);
  const scene = { isUpsideDown: true, aspect: 1.5, background: [1, 0, 0] } as const;
  const settings = settingsOfView(list[0].view, null, list, scene);
  const [back] = readSceneSettings(writeSceneSettings(settings)).annotations;
  expect(back).toMatchObject({ ...words, position: [1, 2, 3] });
  expect(back.camera.fovDegrees).toBeCloseTo(60, 9);
  for (const axis of [0, 1, 2]) expect(back.camera.position[axis]).toBeCloseTo(initial.position[axis], 9);
});

const FAR = 1e308;
/**
 * @fault Arguments: settings, a URL or a saved view have a camera at its target, at a pole, out of
 *   float32's range, or too far away to see anything
 * @consequence a message, and the whole scene; the home view too
 */
it.each([
  [
    [0, 0, 5],
    [0, 0, 5],
  ],
  [
    [FAR, FAR, FAR],
    [0, 0, 0],
  ],
  [
    [0, 0, 5],
    [-FAR, 0, 0],
  ],
  [
    [1e10, 0, 1e-9],
    [1e10, 0, 0],
  ],
])('a camera at %j that looks at %j is told, and the scene is shown as it is', async (position, target) => {
  store.setState({ scene: sceneOf('a.ply') });
  const initial = { position, target, fov: 60 };
  await follow(null, { ...SETTINGS, cameras: [{ initial }] });
  const annotation = { position: [0, 0, 0], title: '', text: '', camera: { initial } };
  const message = expect.stringMatching(/^The target of the camera is \[.*but must be a place other than/);
  expect(store.getState().failure).toMatchObject({ title: 'The settings cannot be used', message });
  await follow(null, { ...SETTINGS, annotations: [annotation] });
  expect(store.getState().failure?.message).toContain('annotations[0].camera');
  expect(restore).not.toHaveBeenCalled();
  expect(store.getState().annotating.list).toEqual([]);
});

it('a track that passes through its target plays on', async () => {
  const setMotion = vi.fn();
  const controls = { pose: {}, moveTo: vi.fn((pose: object) => Object.assign(controls, { pose })) };
  const playing = { camera: { setLook, restore, setMotion, controls } } as unknown as Viewer;
  vi.stubGlobal('matchMedia', () => ({ matches: false }));
  const keyframes = {
    times: [0, 2],
    values: { position: [0, 0, 1, 0, 0, -1], target: [0, 0, 0, 0, 0, 0], fov: [60, 60] },
  };
  const track = { duration: 2, frameRate: 1, loopMode: 'none', interpolation: 'spline', keyframes };
  const settings = fileOf({ ...SETTINGS, animTracks: [track], startMode: 'animTrack' });
  store.setState({ scene: sceneOf('a.ply') });
  await followDroppedSettings(settings, null, store, playing);
  const motion = setMotion.mock.lastCall?.[0] as (elapsedMs: number) => boolean;
  // Exactly at the target after the second.
  expect([motion(500), motion(500), motion(500)]).toEqual([true, true, true]);
  expect(controls.moveTo).toHaveBeenCalledTimes(2);
});

/** Serves a `settings.json` of so many mebibytes, or without an end; returns whether it was cancelled. */
function serveMebibytes(count: number): { isCancelled: boolean; sent: number } {
  const state = { isCancelled: false, sent: 0 };
  const body = new ReadableStream({
    pull(controller) {
      if (state.sent++ < count) controller.enqueue(new Uint8Array(2 ** 20).fill(32));
      else controller.close();
    },
    cancel() {
      state.isCancelled = true;
    },
  });
  vi.stubGlobal('location', { href: 'https://example.org/' });
  vi.stubGlobal('fetch', async () => new Response(body));
  return state;
}

/**
 * @fault Arguments: the server of `?settings=` sends without end, or nothing
 * @consequence at most 16 MiB are read, for at most 30 s; the reason is shown, and the scene as it is
 */
it('an address that sends without end is read no further than any settings are long', async () => {
  const served = serveMebibytes(Number.POSITIVE_INFINITY);
  await followSettings('https://user:secret@other.example/s.json', {}, store, viewer);
  expect(served.isCancelled).toBe(true);
  expect(served.sent).toBeLessThan(20);
  expect(store.getState().failure).toMatchObject({
    message: 'https://other.example/s.json has more than 17 MB: that is no settings.json.',
    advice: expect.stringContaining('?settings='),
  });
});

it('an address that sends nothing is given up', async () => {
  vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout'] });
  vi.stubGlobal('location', { href: 'https://example.org/' });
  vi.stubGlobal(
    'fetch',
    (_: URL, { signal }: { signal: AbortSignal }) =>
      new Promise((_, reject) => signal.addEventListener('abort', () => reject(signal.reason))),
  );
  const followed = followSettings('s.json', {}, store, viewer);
  await vi.advanceTimersByTimeAsync(31_000);
  await followed;
  const message = expect.stringContaining('https://example.org/s.json cannot be read within 30 s');
  expect(store.getState().failure).toMatchObject({ message });
});
