import { beforeEach, expect, it, vi } from 'vitest';
import type { SceneSummary } from '../state/scene-summary.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import { followDroppedSettings } from './follow-settings.ts';
import { readSceneSettings } from './scene-settings.ts';
import { settingsOfView } from './settings-of-view.ts';
import { writeSceneSettings } from './write-settings.ts';

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
  const settings = settingsOfView(list[0].view, [], list, scene);
  const [back] = readSceneSettings(writeSceneSettings(settings)).annotations;
  expect(back).toMatchObject({ ...words, position: [1, 2, 3] });
  expect(back.camera.fovDegrees).toBeCloseTo(60, 9);
  for (const axis of [0, 1, 2]) expect(back.camera.position[axis]).toBeCloseTo(initial.position[axis], 9);
});
