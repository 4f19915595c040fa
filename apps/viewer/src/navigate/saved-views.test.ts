import { describe, expect, it, vi } from 'vitest';
import { ViewCamera } from '../camera/view-camera.ts';
import { redoEdit, undoEdit } from '../state/make-edit.ts';
import type { SceneSummary } from '../state/scene.ts';
import { createViewerStore } from '../state/store.ts';
import { SavedViews } from './saved-views.ts';

function opened(isMotionReduced = true) {
  const store = createViewerStore();
  store.setState({ widthPx: 300, heightPx: 200, scene: { contentKey: 'a', canFlip: true } as SceneSummary });
  const camera = new ViewCamera(store, { onChange: () => {}, isMotionReduced: () => isMotionReduced });
  const sphere = { center: [0, 0, 0], radius: 10 } as const;
  const plain = { firstView: null, ownCameras: null, isUpsideDown: false, framing: null, detail: null };
  camera.follow({ sphere, extent: sphere, ...plain });
  camera.showFirstView();
  const draw = vi.fn(async (): Promise<string | null> => '/9j/');
  const views = new SavedViews({ store, camera, draw });
  views.watch();
  const turn = () =>
    camera.controls.moveTo({ ...camera.controls.pose, azimuth: camera.controls.pose.azimuth + 1 });
  return { store, camera, draw, views, turn };
}

describe('saved views', () => {
  it('have names, and small images that links lack', async () => {
    const { store, draw, views } = opened();
    await views.save();
    for (const name of ['Fro', 'Front']) views.rename(store.getState().savedViews[0], name, 'typing');
    undoEdit(store);
    expect(store.getState().savedViews[0].name).toBe('');
    redoEdit(store);
    store.setState(({ savedViews }) => ({
      savedViews: [...savedViews, { ...savedViews[0], thumbnail: null }],
    }));
    draw.mockResolvedValueOnce('/9j/2');
    await views.complete(store.getState().savedViews[1]);
    expect(store.getState().savedViews).toMatchObject([
      { name: 'Front', thumbnail: '/9j/' },
      { name: 'Front', thumbnail: '/9j/2' },
    ]);
    views.remove(store.getState().savedViews[0]);
    expect(store.getState().savedViews).toMatchObject([{ thumbnail: '/9j/2' }]);
    undoEdit(store);
    expect(store.getState().savedViews).toHaveLength(2);
  });

  it('show again where the camera was, how it looked and which way was up', async () => {
    const { store, camera, views, turn } = opened();
    camera.setUpAxis('-z');
    camera.setLook({ fovDegrees: 30, isOrthographic: true });
    await views.save();
    const saved = camera.snapshot();
    camera.setUpAxis('y');
    camera.setLook({ fovDegrees: 70, isOrthographic: false });
    turn();
    camera.goTo(store.getState().savedViews[0]);
    expect(camera.snapshot()).toMatchObject({
      pose: saved.pose,
      fovDegrees: 30,
      isFlipped: true,
      isZUp: true,
    });
    expect(store.getState().look.isOrthographic).toBe(true);
  });

  it('make a path that is played, paused, and ends at the last', async () => {
    const { store, camera, views, turn } = opened(false);
    await views.save();
    turn();
    await views.save();
    const { azimuth } = camera.controls.pose;
    views.play();
    camera.update(250);
    // It sets out slowly.
    expect(camera.controls.pose.azimuth).toBeLessThan(azimuth - 0.95);
    expect(camera.update(1000)).toBe(true);
    const half = camera.controls.pose.azimuth;
    expect(half).toBeCloseTo(azimuth - 0.5);
    camera.endPath();
    expect(camera.update(1250)).toBe(false);
    expect(camera.controls.pose.azimuth).toBe(half);
    views.play();
    camera.update(5000);
    expect(camera.controls.pose.azimuth).toBeCloseTo(azimuth);
    expect(camera.update(16)).toBe(false);
    expect(store.getState().isPathPlaying).toBe(false);
  });

  it('are shown one after the other where motion is reduced', async () => {
    const { camera, views, turn } = opened();
    await views.save();
    turn();
    await views.save();
    const { azimuth } = camera.controls.pose;
    views.play();
    camera.update(2400);
    expect(camera.controls.pose.azimuth).toBeCloseTo(azimuth - 1);
    camera.update(100);
    expect(camera.controls.pose.azimuth).toBeCloseTo(azimuth);
  });

  it('let go of the camera when somebody takes hold of the image', async () => {
    const { store, camera, views, turn } = opened();
    await views.save();
    turn();
    await views.save();
    views.play();
    camera.update(100);
    turn();
    expect(camera.update(16)).toBe(false);
    expect(store.getState().isPathPlaying).toBe(false);
  });

  it('are not saved of another scene that came meanwhile, or of nothing', async () => {
    const { store, draw, views } = opened();
    draw.mockResolvedValueOnce(null);
    await views.save();
    const saving = views.save();
    store.setState({ scene: { contentKey: 'b' } as SceneSummary });
    await saving;
    expect(store.getState().savedViews).toEqual([]);
  });
});
