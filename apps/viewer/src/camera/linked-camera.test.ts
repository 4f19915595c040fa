import { orthographicCamera } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { createViewerStore } from '../state/store.ts';
import { flippedPose } from './flip.ts';
import { orbitNear } from './orbit-near.ts';
import { FRONT } from './orbit-pose.fixture.ts';
import { type CameraSubject, ViewCamera } from './view-camera.ts';

const SPHERE = { center: [1, 2, 3] as const, radius: 1 };
const subject: CameraSubject = {
  sphere: SPHERE,
  extent: SPHERE,
  firstView: null,
  ownCameras: null,
  isUpsideDown: true,
  framing: null,
  detail: null,
};

function cameraOf(what: CameraSubject) {
  const store = createViewerStore();
  const scene = { canFlip: what.ownCameras === null } as NonNullable<
    ReturnType<typeof store.getState>['scene']
  >;
  store.setState({ widthPx: 300, heightPx: 200, scene });
  const camera = new ViewCamera(store, { onChange: () => {}, isMotionReduced: () => true });
  camera.follow(what);
  return { camera, store };
}

describe('a camera from a link', () => {
  const pose = { ...FRONT, target: [0.1, 0.2, 0.3] as const, azimuth: 7.123456789012345 };

  it('is where the link says, and goes home to the first view', () => {
    const { camera } = cameraOf(subject);
    camera.showFirstView();
    const { home } = camera.snapshot();
    const linked = {
      ...{ pose, fovDegrees: 33.3, isOrthographic: true, cameraIndex: 0 },
      ...{ isFlipped: true, isZUp: false },
    };
    camera.showLinked(linked);
    expect(camera.snapshot()).toEqual({ ...linked, home });
    expect(camera.first?.pose).toEqual(home.pose);
  });

  it('shows the scene the way up that the link says', () => {
    const { camera, store } = cameraOf(subject);
    camera.showFirstView();
    const { home } = camera.snapshot();
    camera.showLinked({ ...camera.snapshot(), pose, fovDegrees: 50, isFlipped: false });
    expect(store.getState().isFlipped).toBe(false);
    expect(camera.snapshot()).toMatchObject({ pose, home });
    expect(camera.controls.home).toEqual(flippedPose(home.pose));
    expect(camera.first?.isFlipped).toBe(true);
  });

  it('shows the scene with the axis upwards that the link says', () => {
    const { camera } = cameraOf(subject);
    camera.showFirstView();
    const zUp = { ...pose, up: [0, 0, 1] as const };
    camera.showLinked({ ...camera.snapshot(), pose: zUp, isFlipped: false, isZUp: true });
    expect(camera.snapshot()).toMatchObject({ pose: zUp, isFlipped: false, isZUp: true });
    expect(camera.controls.home.up).toEqual([0, 0, 1]);
  });

  it('is one of the scene’s own where the link stood at it, and never turns that scene', () => {
    const own = (aspect: number) =>
      orthographicCamera({ position: [0, 0, 5], target: [0, 0, 0], aspect, height: 2 });
    const side = (aspect: number) =>
      orthographicCamera({ position: [5, 0, 0], target: [0, 0, 0], aspect, height: 2 });
    const { camera, store } = cameraOf({
      ...subject,
      isUpsideDown: false,
      ownCameras: { at: (aspect) => ({ front: own(aspect), side: side(aspect) }), orbitNear },
    });
    camera.showFirstView();
    store.setState(({ scene }) => ({ scene: scene && { ...scene, cameras: camera.ownCameraNames } }));
    camera.step(1);
    expect(store.getState().cameraIndex).toBe(1);
    const linked = camera.snapshot();
    camera.showLinked({ ...linked, cameraIndex: 1, isFlipped: true });
    expect(camera.snapshot()).toMatchObject({ isFlipped: false, pose: linked.pose, home: linked.home });
  });
});
