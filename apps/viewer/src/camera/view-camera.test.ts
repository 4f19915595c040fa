import { describe, expect, it, vi } from 'vitest';
import type { SceneSummary } from '../state/scene-summary.ts';
import { createViewerStore } from '../state/store.ts';
import { type CameraSubject, ViewCamera } from './view-camera.ts';

const SPHERE = { center: [0, 0, 0], radius: 1 } as const;
const GROUND: CameraSubject = {
  sphere: SPHERE,
  extent: SPHERE,
  firstView: null,
  ownCameras: null,
  isUpsideDown: true,
  isZUp: true,
};

function shown(subject: CameraSubject) {
  const store = createViewerStore();
  store.setState({ widthPx: 300, heightPx: 200, scene: { canFlip: true } as SceneSummary });
  const onChange = vi.fn();
  const camera = new ViewCamera(store, { onChange, isMotionReduced: () => true });
  camera.follow(subject);
  camera.showFirstView();
  return { store, camera, onChange };
}

describe('the camera of a scene', () => {
  it('shows a scene with the axis up that it probably has', () => {
    const { store, camera } = shown(GROUND);
    expect(store.getState()).toMatchObject({ isFlipped: false, isZUp: true });
    expect(camera.controls.pose.up).toEqual([0, 0, 1]);
  });

  it('learns which way is up when all of a scene is there, unless a person has said so', () => {
    const part = { ...GROUND, isZUp: false };
    const untouched = shown(part);
    untouched.camera.follow(GROUND);
    untouched.camera.showFirstViewAgain();
    expect(untouched.store.getState()).toMatchObject({ isFlipped: false, isZUp: true });
    const touched = shown(part);
    touched.camera.toggleFlip();
    touched.camera.follow(GROUND);
    touched.camera.showFirstViewAgain();
    expect(touched.store.getState()).toMatchObject({ isFlipped: false, isZUp: false });
  });

  it('turns with the axis that is chosen, and is home there', () => {
    const { store, camera } = shown({ ...GROUND, isZUp: false });
    const { polar, distance } = camera.controls.pose;
    camera.setUpAxis('-z');
    expect(store.getState()).toMatchObject({ isFlipped: true, isZUp: true });
    expect(camera.controls.pose).toMatchObject({ up: [0, 0, 1], polar, distance });
    expect(camera.controls.isHome).toBe(true);
  });

  it('shows the target as large in parallel as in perspective', () => {
    const { camera, onChange } = shown(GROUND);
    camera.update(16);
    const { distance } = camera.controls.pose;
    const perspective = camera.orbitCamera.projectionMatrix;
    onChange.mockClear();
    camera.setLook({ isOrthographic: true });
    expect(onChange).toHaveBeenCalledOnce();
    const parallel = camera.orbitCamera.projectionMatrix;
    expect(parallel[11]).toBe(0);
    expect(parallel[5]).toBeCloseTo(perspective[5] / distance);
  });

  it('comes back to what it was', () => {
    const { store, camera } = shown(GROUND);
    camera.setLook({ fovDegrees: 70 });
    const before = camera.snapshot();
    camera.setUpAxis('y');
    camera.setLook({ fovDegrees: 20 });
    camera.restore(before);
    expect(camera.snapshot()).toEqual(before);
    expect(store.getState().look.fovDegrees).toBe(70);
  });
});
