import { expect, it } from 'vitest';
import { ViewCamera } from '../camera/view-camera.ts';
import { cameraAxes, lookAt } from '../state/orbit-pose.ts';
import { createViewerStore } from '../state/store.ts';
import { dot, subtract } from '../state/vec3.ts';
import { FLOOR, ground } from './boxes.fixture.ts';
import { isOtherGround, Walk } from './walk.ts';
import { EYES_M, Walker } from './walker.ts';

/** A walk on the floor of a scene whose z axis points up. */
function begun() {
  const store = createViewerStore();
  const camera = new ViewCamera(store, { onChange: () => {} });
  const up = [0, 0, 1] as const;
  const pose = { target: [0, 9, 0], distance: 9, azimuth: 0.5, polar: Math.PI / 2, up } as const;
  camera.controls.setPose(pose);
  const axes = cameraAxes({ ...pose, azimuth: 0 });
  const walk = new Walk(store, camera, new Walker(ground(FLOOR), [0, 0, 0], EYES_M), axes);
  store.setState({ travelling: walk.begun });
  return { store, camera, walk, position: () => lookAt(camera.controls.pose).position };
}

it('walks where the camera looks, whichever axis points up', () => {
  const { camera, walk, position } = begun();
  walk.move(null, false, 0);
  expect(position()).toEqual([0, 0, EYES_M].map((value) => expect.closeTo(value, 9)));
  const { right, back } = cameraAxes(camera.controls.pose);
  expect(walk.move([0, 0, 1], false, 1000)).toBe(true);
  const ahead = position();
  expect(dot(ahead, back)).toBeCloseTo(-2, 1);
  expect(dot(ahead, right)).toBeCloseTo(0, 9);
  // A stick that is pushed half of its way.
  walk.move([0.5, 0, 0], false, 1000);
  expect(dot(subtract(position(), ahead), right)).toBeCloseTo(1, 1);
  expect(cameraAxes(camera.controls.pose)).toMatchObject({ right, back });
});

it('is as high as it is said to be, and at rest asks for no frame', () => {
  const { store, walk, position } = begun();
  walk.move(null, false, 0);
  walk.scale(0.5);
  expect(store.getState().travelling).toEqual({ by: 'walk', eyeHeight: EYES_M / 2 });
  walk.move(null, false, 100);
  expect(position()[2]).toBeCloseTo(EYES_M / 2, 9);
  expect(walk.move(null, false, 100)).toBe(false);
});

it('says that the ground has ended, and ends when something else moves the camera', () => {
  const { store, camera, walk, position } = begun();
  for (let i = 0; i < 500 && store.getState().notice === null; i++) walk.move([0, 0, 1], true, 10);
  expect(store.getState().notice).toMatch(/back where you last stood/);
  expect(Math.hypot(...position())).toBeLessThan(6);
  camera.controls.setPose({ ...camera.controls.pose, target: [1, 2, 3] });
  expect(walk.move(null, false, 16)).toBe(false);
  expect(store.getState().travelling).toBeNull();
});

it('is over on other ground alone', () => {
  const before = createViewerStore().getState();
  const { inspecting } = before;
  const crop = { min: [0, 0, 0], max: [1, 1, 1], keep: 'inside' } as const;
  expect(isOtherGround({ ...before, isFlipped: true }, before)).toBe(true);
  expect(isOtherGround({ ...before, inspecting: { ...inspecting, crop } }, before)).toBe(true);
  expect(isOtherGround({ ...before, isHudVisible: false }, before)).toBe(false);
});
