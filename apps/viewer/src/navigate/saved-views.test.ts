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

  it('are put at other times and in another order, each of which is one edit', async () => {
    const { store, views, turn } = opened();
    for (const name of ['A', 'B', 'C']) {
      await views.save();
      views.rename(store.getState().savedViews.at(-1)!, name, name);
      turn();
    }
    const order = () => store.getState().savedViews.map(({ name, toNextMs }) => `${name} ${toNextMs ?? ''}`);
    const first = order();
    views.moveTo(2, 1249);
    expect(order()).toEqual(['A 1200', 'C 1300', 'B ']);
    views.moveTo(0, 2000);
    expect(order()).toEqual(['C 800', 'A 500', 'B ']);
    views.shift(1, 1);
    expect(order()).toEqual(['C 800', 'B 500', 'A ']);
    views.shift(2, 1);
    views.setPassing(store.getState().savedViews[0], { toNextMs: 20, passing: 'stop' });
    expect(order()[0]).toBe('C 100');
    for (const name of ['timing of a view', 'move of a view', 'move of a view', 'move of a view'])
      expect(undoEdit(store)?.name).toBe(name);
    expect(order()).toEqual(first);
  });

  it('take what is on the screen in the place of one, whose name and time stay', async () => {
    const { store, camera, draw, views, turn } = opened();
    await views.save();
    views.rename(store.getState().savedViews[0], 'Door', null);
    views.setPassing(store.getState().savedViews[0], { toNextMs: 4000 });
    turn();
    draw.mockResolvedValueOnce('/9j/2');
    await views.overwrite(store.getState().savedViews[0]);
    const { pose } = camera.controls;
    expect(store.getState().savedViews).toMatchObject([
      { name: 'Door', toNextMs: 4000, thumbnail: '/9j/2', pose },
    ]);
  });

  it('are not needed for a turntable, which plays around and around, and can become views', () => {
    const { store, camera, views } = opened(false);
    const { azimuth } = camera.controls.pose;
    views.setTurntable(4000);
    views.play();
    camera.update(1000);
    expect(camera.controls.pose.azimuth).toBeCloseTo(azimuth + Math.PI / 2);
    camera.update(3500);
    expect(store.getState()).toMatchObject({ isPathPlaying: true, playheadMs: 500 });
    views.scrub(2000);
    expect(store.getState().isPathPlaying).toBe(false);
    expect(camera.controls.pose.azimuth).toBeCloseTo(azimuth + Math.PI);
    views.keepTurntable();
    expect(store.getState()).toMatchObject({ path: { isLooped: true, turntable: null } });
    expect(store.getState().savedViews.map(({ toNextMs }) => toNextMs)).toEqual([1000, 1000, 1000, 1000]);
    for (let i = 0; i < 2; i++) undoEdit(store);
    expect(store.getState()).toMatchObject({ savedViews: [], path: { isLooped: false, turntable: null } });
  });

  it('end their path when another scene comes', async () => {
    const { store, camera, views } = opened(false);
    views.setTurntable(4000);
    views.play();
    camera.update(100);
    store.setState({ scene: { contentKey: 'b' } as SceneSummary });
    expect(camera.update(16)).toBe(false);
    expect(store.getState().isPathPlaying).toBe(false);
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
