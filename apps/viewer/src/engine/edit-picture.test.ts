import { ACCURACY_PRESETS } from '@websplatter/core';
import { beforeEach, expect, it, vi } from 'vitest';
import { ViewCamera } from '../camera/view-camera.ts';
import { redoEdit, undoEdit } from '../state/make-edit.ts';
import type { SceneSummary } from '../state/scene.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import { UNDONE } from '../state/undone.ts';
import { editPicture } from './edit-picture.ts';
import type { PanelProps, Viewer } from './viewer.ts';

let store: ViewerStore;
let panel: PanelProps;
const followSettings = vi.fn();

beforeEach(() => {
  store = createViewerStore();
  store.setState({ widthPx: 300, heightPx: 200, scene: { canFlip: true } as SceneSummary });
  const camera = new ViewCamera(store, { onChange: () => {}, isMotionReduced: () => true });
  panel = { store, viewer: { camera, followSettings } as unknown as Viewer };
});

const names = () => store.getState().past.map(({ name }) => name);
const { fast, paper } = ACCURACY_PRESETS;
const isFlipped = () => store.getState().isFlipped;

/** A change of each setting of the picture, by its name in `UNDONE`. */
const CHANGES: Readonly<Record<string, () => void>> = {
  up: () => panel.viewer.camera.setUpAxis('-z'),
  look: () => panel.viewer.camera.setLook({ background: '#000000', fovDegrees: 90, isOrthographic: true }),
  viewMode: () => store.setState({ viewMode: 'depth' }),
  accuracy: () => store.setState({ accuracy: fast, target: null }),
  detail: () => store.setState({ detail: { maxSplats: 7 }, isDetailChosen: true }),
  comparison: () => store.setState({ comparison: { kind: 'error' } }),
  effects: () =>
    store.setState(({ requested }) => ({
      requested: { ...requested, choices: { tint: { isOn: true, values: {} } }, text: 'tint' },
    })),
};
const SETTINGS = [...new Set(Object.values(UNDONE))].filter((way) => way !== null && way !== 'own');

/** All that undo has to bring back. */
const picture = () => {
  const state = store.getState();
  const fields = Object.entries(UNDONE).filter(([, way]) => way !== null);
  return Object.fromEntries(fields.map(([name]) => [name, state[name as keyof typeof state]]));
};

/**
 * @fault Order: a person changes a setting of the picture
 * @consequence it is a step of the undo, whichever setting it is
 */
it.each(SETTINGS)('takes a change of %s back, and makes it again', (setting) => {
  const first = picture();
  editPicture(panel, setting, CHANGES[setting]);
  const changed = picture();
  expect(changed).not.toEqual(first);
  expect(names()).toEqual([setting]);
  undoEdit(store);
  expect(picture()).toEqual(first);
  redoEdit(store);
  expect(picture()).toEqual(changed);
  expect(followSettings).toHaveBeenCalled();
});

it('makes no step of what changes nothing', () => {
  editPicture(panel, 'up axis', () => panel.viewer.camera.setUpAxis('y'));
  editPicture(panel, 'accuracy', () => store.setState({ accuracy: store.getState().accuracy }));
  editPicture(panel, 'background', () => panel.viewer.camera.setLook({ background: 'theme' }));
  expect(names()).toEqual([]);
});

it('takes a drag of a slider back at once, and the next drag by itself', () => {
  for (const drag of [
    [20, 30, 40],
    [50, 60],
  ])
    for (const fovDegrees of drag)
      editPicture(panel, 'field of view', () => panel.viewer.camera.setLook({ fovDegrees }), drag);
  expect(names()).toEqual(['field of view', 'field of view']);
  const fov = () => store.getState().look.fovDegrees;
  undoEdit(store);
  expect(fov()).toBe(40);
  undoEdit(store);
  expect(fov()).toBe(50);
  redoEdit(store);
  redoEdit(store);
  expect(fov()).toBe(60);
});

it('leaves the rest of the look as a saved view has changed it', () => {
  editPicture(panel, 'background', () => panel.viewer.camera.setLook({ background: '#ffffff' }));
  panel.viewer.camera.setLook({ fovDegrees: 30 });
  undoEdit(store);
  expect(store.getState().look).toMatchObject({ background: 'theme', fovDegrees: 30 });
});

it('goes back from a target to the settings before, also those that were found for it', () => {
  store.setState({ accuracy: paper });
  editPicture(panel, 'target', () => store.setState({ target: { minPsnrDb: 45 }, choice: null }));
  // As the engine finds them.
  store.setState({ accuracy: fast, choice: { settings: fast } as never });
  undoEdit(store);
  expect(store.getState()).toMatchObject({ accuracy: paper, target: null, choice: null });
});

it('turns the scene back by the camera', () => {
  editPicture(panel, 'up axis', () => panel.viewer.camera.toggleFlip());
  expect(isFlipped()).toBe(true);
  undoEdit(store);
  expect(isFlipped()).toBe(false);
});
