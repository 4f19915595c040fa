import { OrthographicCamera, PerspectiveCamera, Vector3 } from 'three';
import { FirstPersonControls } from 'three/addons/controls/FirstPersonControls.js';
import { FlyControls } from 'three/addons/controls/FlyControls.js';
import { MapControls } from 'three/addons/controls/MapControls.js';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { TrackballControls } from 'three/addons/controls/TrackballControls.js';
import { expect, it } from 'vitest';
import { aimControls } from './bounds-fitter.ts';
import type { FittedCamera } from './fit-camera.ts';

const TARGET = new Vector3(3, -2, 1);
const PLACE = [3, -2, 8];

function fittedCameras(): FittedCamera[] {
  const cameras = [new PerspectiveCamera(50, 1, 0.1, 100), new OrthographicCamera(-1, 1, 1, -1, 0.1, 100)];
  for (const camera of cameras) {
    camera.position.fromArray(PLACE);
    camera.zoom = 0.25;
    camera.updateMatrixWorld();
  }
  return cameras;
}

it.each([
  ['OrbitControls', OrbitControls],
  ['MapControls', MapControls],
  ['TrackballControls', TrackballControls],
] as const)('three’s %s turn about the target from where the camera is', (_, Controls) => {
  for (const camera of fittedCameras()) {
    const controls = new Controls(camera);
    aimControls(controls, camera, TARGET);
    controls.update();
    expect(controls.target.toArray()).toEqual(TARGET.toArray());
    for (const [axis, value] of camera.position.toArray().entries())
      expect(value).toBeCloseTo(PLACE[axis], 9);
    expect(camera.getWorldDirection(new Vector3()).z).toBeCloseTo(-1, 9);
  }
});

it.each([
  ['FlyControls', FlyControls],
  ['FirstPersonControls', FirstPersonControls],
] as const)('%s, which turn about nothing, are not updated without a time', (_, Controls) => {
  for (const camera of fittedCameras()) {
    const controls = Object.assign(new Controls(camera), { autoForward: true });
    aimControls(controls, camera, TARGET);
    expect(camera.position.toArray()).toEqual(PLACE);
    expect(camera.quaternion.toArray()).toEqual([0, 0, 0, 1]);
  }
});

/**
 * @fault three.js and React: `<SplatBounds>` fits a camera whose controls own its place
 *   (`CameraControls`), turn it about a point, or do neither
 */
it('gives place and target at once to controls that own the camera’s place', () => {
  for (const camera of fittedCameras()) {
    const calls: Record<string, unknown[]> = {};
    const called = (name: string) =>
      function (this: unknown, ...given: unknown[]) {
        expect(this).toBe(controls);
        calls[name] = given;
      };
    const controls = {
      setLookAt: called('setLookAt'),
      setFocalOffset: called('setFocalOffset'),
      zoomTo: called('zoomTo'),
      updateCameraUp: called('updateCameraUp'),
      update: called('update'),
    };
    aimControls(controls, camera, TARGET);
    expect(calls).toEqual({
      updateCameraUp: [],
      setLookAt: [...PLACE, ...TARGET.toArray(), false],
      setFocalOffset: [0, 0, 0, false],
      ...('isOrthographicCamera' in camera && { zoomTo: [0.25, false] }),
    });
  }
});

it('leaves a Canvas without controls, and what is none, as they are', () => {
  const [camera] = fittedCameras();
  for (const controls of [null, {}, { target: 'a' }, { target: null, update: () => expect.unreachable() }])
    expect(() => aimControls(controls, camera, TARGET)).not.toThrow();
});
