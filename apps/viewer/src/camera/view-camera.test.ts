import { perspectiveCamera, type SceneFraming } from '@websplatter/core';
import { describe, expect, it, vi } from 'vitest';
import { lookAt } from '../state/orbit-pose.ts';
import type { SceneSummary } from '../state/scene.ts';
import { createViewerStore } from '../state/store.ts';
import { NOTHING_COVERED } from './covered.ts';
import { flippedPoint } from './flip.ts';
import { orbitNear } from './orbit-near.ts';
import { type CameraSubject, ViewCamera } from './view-camera.ts';

const SPHERE = { center: [0, 0, 0], radius: 1 } as const;
const GROUND: CameraSubject = {
  sphere: SPHERE,
  extent: SPHERE,
  firstView: null,
  ownCameras: null,
  isUpsideDown: true,
  framing: null,
  detail: null,
};
const FRAMING: SceneFraming = {
  kind: 'surrounded',
  position: [0, -4, 1],
  target: [0, 0, 0.5],
  up: [0, 0, 1],
  fovYDegrees: 50,
  center: [0, 0, 0.5],
  radius: 2,
  groundHeight: 0.25,
  confidence: { up: 0.9, kind: 0.9 },
};
const framed = (framing: SceneFraming): CameraSubject => ({
  ...GROUND,
  framing,
  detail: { center: framing.center, radius: framing.radius },
});
/** In degrees around x, from y up. */
const tilted = (degrees: number): SceneFraming['up'] => {
  const radians = (degrees * Math.PI) / 180;
  return [0, Math.cos(radians), Math.sin(radians)];
};

function shown(subject: CameraSubject, isMotionReduced = true) {
  const store = createViewerStore();
  store.setState({ widthPx: 300, heightPx: 200, scene: { canFlip: true } as SceneSummary });
  const onChange = vi.fn();
  const camera = new ViewCamera(store, { onChange, isMotionReduced: () => isMotionReduced });
  camera.follow(subject);
  camera.showFirstView();
  return { store, camera, onChange };
}

function expectView(camera: ViewCamera, expected: Pick<SceneFraming, 'position' | 'target' | 'up'>): void {
  const view = lookAt(camera.controls.pose);
  for (const name of ['position', 'target', 'up'] as const)
    for (const axis of [0, 1, 2]) expect(view[name][axis], name).toBeCloseTo(expected[name][axis], 9);
}

describe('the camera of a scene', () => {
  it('shows a scene first as it was framed, with the axis up that comes closest', () => {
    const { store, camera } = shown(framed(FRAMING));
    expect(store.getState()).toMatchObject({ isFlipped: false, isZUp: true, firstUp: 'z' });
    expectView(camera, FRAMING);
    expect(camera.controls.isHome).toBe(true);
    expect(camera.groundHeight).toBe(0.25);
  });

  it.each([15, 80, 165, 260, 345])('shows a capture upright whose up is %i° from y', (degrees) => {
    const up = tilted(degrees);
    const { store, camera } = shown(framed({ ...FRAMING, position: [5, 0, 0], target: [1, 0, 0], up }));
    const turned = store.getState().isFlipped ? flippedPoint(up) : up;
    expectView(camera, { position: [5, 0, 0], target: [1, 0, 0], up: turned });
    expect(camera.upInScene.map((value, axis) => value - up[axis])).toEqual([
      expect.closeTo(0),
      expect.closeTo(0),
      expect.closeTo(0),
    ]);
    // The other way up, it is exactly that.
    camera.toggleFlip();
    const [x, y, z] = camera.upInScene;
    expect([x, y + up[1], z + up[2]]).toEqual([expect.closeTo(0), expect.closeTo(0), expect.closeTo(0)]);
    expect(camera.controls.isHome).toBe(true);
  });

  it('shows a scene by its bounds, with the axis up of its format, where it was not framed', () => {
    const { store, camera } = shown(GROUND);
    expect(store.getState()).toMatchObject({ isFlipped: true, isZUp: false });
    expect(camera.controls.pose).toMatchObject({ target: [0, 0, 0], up: [0, 1, 0] });
  });

  it('goes to the first view of all of a scene, unless the view was moved: then Home does', () => {
    const untouched = shown(GROUND);
    untouched.camera.follow(framed(FRAMING));
    untouched.camera.showFirstViewAgain();
    expect(untouched.store.getState()).toMatchObject({ isFlipped: false, isZUp: true });
    expectView(untouched.camera, FRAMING);
    const moved = shown(GROUND);
    const pose = { ...moved.camera.controls.pose, distance: 9 };
    moved.camera.controls.moveTo(pose);
    moved.camera.follow(framed(FRAMING));
    moved.camera.showFirstViewAgain();
    expect(moved.camera.controls.pose).toEqual(pose);
    moved.camera.controls.reset();
    const up = flippedPoint(FRAMING.up);
    expectView(moved.camera, { position: flippedPoint(FRAMING.position), target: [0, 0, -0.5], up });
  });

  it('stays as somebody has turned or placed it', () => {
    const { store, camera } = shown(GROUND);
    camera.toggleFlip();
    const { pose } = camera.controls;
    camera.follow(framed(FRAMING));
    camera.showFirstViewAgain();
    expect(camera.controls.pose).toEqual(pose);
    expect(store.getState()).toMatchObject({ isFlipped: false, isZUp: false });
    expect(camera.isFoundFirst).toBe(false);
    camera.showFirstView();
    expect(camera.isFoundFirst).toBe(true);
    camera.restore({ ...camera.snapshot(), pose, home: { ...camera.keptView, pose } });
    camera.showFirstViewAgain();
    expect(camera.controls.pose).toEqual(pose);
  });

  it('frames a scene from where it is turned to, as near as the first view, or whole where that is not known', () => {
    const { camera } = shown(framed(FRAMING));
    const { azimuth, distance } = camera.controls.pose;
    camera.controls.moveTo({
      ...camera.controls.pose,
      azimuth: azimuth + 1,
      distance: 30,
      target: [7, 7, 7],
    });
    camera.frameScene();
    expect(camera.controls.pose).toMatchObject({ azimuth: azimuth + 1, target: [0, 0, 0.5] });
    expect(camera.controls.pose.distance).toBeCloseTo(distance);
    camera.setLook({ fovDegrees: 25 });
    camera.frameScene();
    expect(camera.controls.pose.distance).toBeGreaterThan(1.9 * distance);
    camera.follow({ ...framed(FRAMING), detail: null });
    camera.frameScene();
    expect(camera.controls.pose.target).toEqual([0, 0, 0]);
  });

  it('goes to a framing that is asked for, and is home there', () => {
    const { camera } = shown(framed(FRAMING));
    const { first } = camera;
    camera.follow(framed({ ...FRAMING, kind: 'object', position: [0, -20, 6] }));
    camera.goToFraming();
    expectView(camera, { ...FRAMING, position: [0, -20, 6] });
    expect(camera.controls.isHome).toBe(true);
    // A link has to tell.
    expect(camera.first).toBe(first);
  });

  it('turns with the axis that is chosen, and is home there', () => {
    const { store, camera } = shown(GROUND);
    const { polar, distance } = camera.controls.pose;
    camera.setUpAxis('-z');
    expect(store.getState()).toMatchObject({ isFlipped: true, isZUp: true });
    expect(camera.controls.pose).toMatchObject({ up: [0, 0, 1], polar, distance });
    expect(camera.controls.isHome).toBe(true);
  });

  /**
   * @fault Order: a person tries the axes that may be up, and resets the view
   */
  it.each([['z', '-y'], ['z'], ['-z', 'z', 'y', '-y'], ['y', 'z', '-z']] as const)(
    'is reset to the first view after the axes %s',
    (...axes) => {
      const tiltedUp = tilted(170);
      const { store, camera } = shown(
        framed({ ...FRAMING, position: [5, 0, 1], target: [1, 0, 0], up: tiltedUp }),
      );
      const first = camera.snapshot();
      for (const axis of axes) camera.setUpAxis(axis);
      camera.setLook({ fovDegrees: 90, isOrthographic: true });
      camera.reset();
      expect(camera.snapshot()).toEqual(first);
      expect(store.getState().firstUp).toBe('-y');
      // Also from elsewhere, and after the axis that was there at first has come back by itself.
      for (const axis of [...axes, '-y'] as const) camera.setUpAxis(axis);
      expect(camera.snapshot()).toEqual(first);
      camera.controls.moveTo({ ...camera.controls.pose, azimuth: 3, distance: 9 });
      for (const axis of axes) camera.setUpAxis(axis);
      camera.reset();
      expect(camera.snapshot()).toEqual(first);
    },
  );

  it('stays where it is as axes are tried, and faces the same side whatever their order', () => {
    const { camera } = shown(framed(FRAMING));
    const pose = { ...camera.controls.pose, azimuth: 2, polar: 1, distance: 3 };
    camera.controls.moveTo(pose);
    for (const axis of ['-z', 'y', '-y', 'z'] as const) camera.setUpAxis(axis);
    expect(camera.controls.pose).toBe(pose);
    camera.setUpAxis('-y');
    const straight = lookAt(camera.controls.pose);
    camera.setUpAxis('z');
    for (const axis of ['y', '-z', '-y'] as const) camera.setUpAxis(axis);
    expect(lookAt(camera.controls.pose)).toEqual(straight);
    camera.controls.moveTo({ ...camera.controls.pose });
    for (const axis of ['y', 'z', '-z', '-y'] as const) {
      camera.controls.moveTo({ ...camera.controls.pose });
      camera.setUpAxis(axis);
    }
    for (const axis of [0, 1, 2])
      expect(lookAt(camera.controls.pose).position[axis]).toBeCloseTo(straight.position[axis], 9);
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

  it('makes room for a panel and stays where it is', () => {
    const { camera, onChange } = shown(GROUND);
    camera.update(16);
    const before = camera.snapshot();
    const alone = camera.orbitCamera;
    onChange.mockClear();
    camera.setCovered({ left: 0, right: 0.5, top: 0.1, bottom: 0.3 }, false);
    expect(onChange).toHaveBeenCalledOnce();
    expect(camera.update(16)).toBe(false);
    expect(camera.snapshot()).toEqual(before);
    expect(camera.middle).toEqual([0.25, 0.4]);
    const { viewMatrix, projectionMatrix } = camera.orbitCamera;
    expect(viewMatrix).toEqual(alone.viewMatrix);
    // 200 px of the scene's height are 120 px high now: the free area's shorter side.
    expect(projectionMatrix[5] / alone.projectionMatrix[5]).toBeCloseTo(120 / 200);
    expect(projectionMatrix[0] / alone.projectionMatrix[0]).toBeCloseTo(120 / 200);
    expect(camera.centredCamera).toEqual(alone);
    // Home and the whole scene are where they would be without the panel.
    camera.frameScene();
    camera.update(16);
    expect(camera.controls.isHome).toBe(true);
    camera.setCovered(NOTHING_COVERED, false);
    camera.update(16);
    expect(camera.orbitCamera).toEqual(alone);
  });

  it('glides aside, but not where the window has another size', () => {
    const { camera } = shown(GROUND, false);
    camera.setCovered({ ...NOTHING_COVERED, right: 0.5 }, false);
    expect(camera.update(100)).toBe(true);
    const [x] = camera.middle;
    expect(x).toBeLessThan(0.5);
    expect(x).toBeGreaterThan(0.25);
    expect(camera.update(100)).toBe(false);
    camera.setCovered({ ...NOTHING_COVERED, bottom: 0.5 }, true);
    expect(camera.update(16)).toBe(false);
    expect(camera.middle).toEqual([0.5, 0.25]);
  });

  it('leaves the images of the scene’s own cameras as they are, until the view is moved', () => {
    const own = perspectiveCamera({ position: [0, 0, 4], target: [0, 0, 0], aspect: 1.5, fovYDegrees: 50 });
    const { camera } = shown({ ...GROUND, ownCameras: { at: () => ({ own }), orbitNear } });
    camera.setCovered({ ...NOTHING_COVERED, right: 0.5 }, false);
    camera.update(16);
    expect(camera.ownCamera).toBe(own);
    expect(camera.centredCamera).toBe(own);
    expect(camera.middle).toEqual([0.5, 0.5]);
    camera.controls.handleKey({ key: '+', shiftKey: false, ctrlKey: false, metaKey: false, altKey: false });
    camera.update(16);
    expect(camera.ownCamera).toBeUndefined();
    expect(camera.middle).toEqual([0.25, 0.5]);
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

  it.each([
    ['far away', { target: [1e308, -1e308, 1e308] }],
    ['farther than the scene can be seen from', { distance: 1e6 }],
    ['infinitely far from its target', { distance: 1e308 }],
    ['at its target', { distance: 1e-320 }],
    ['at a pole', { polar: 1e-20 }],
    ['of no field of view', {}, 1e-300],
  ] as const)(
    'shows the whole scene instead of a camera %s, and says so',
    (_, change, fovDegrees: number = 50) => {
      const { store, camera } = shown(GROUND);
      const first = camera.snapshot();
      const { pose } = first;
      const view = { ...first, fovDegrees, pose: { ...pose, ...change } };
      const isFirst = () => {
        expect(camera.snapshot()).toEqual(first);
        expect(camera.controls.isHome).toBe(true);
        expect(store.getState().notice).toContain('The view cannot be shown: ');
        expect(() => camera.orbitCamera).not.toThrow();
        store.setState({ notice: null });
      };
      camera.showLinked(view);
      isFirst();
      camera.restore({ ...view, home: view });
      isFirst();
      camera.goTo(view);
      isFirst();
    },
  );

  it.each([true, false])(
    'goes home to the first view if there is an interface (%s), else to the sent one',
    (hasInterface) => {
      const { store, camera } = shown(GROUND);
      const first = camera.snapshot();
      const sent = { ...first.pose, azimuth: first.pose.azimuth + 0.5 };
      store.setState({ hasInterface });
      camera.showLinked({ ...first, pose: sent });
      expect(camera.controls.pose).toEqual(sent);
      expect(camera.controls.home).toEqual(hasInterface ? first.pose : sent);
    },
  );

  /**
   * @fault Arguments: settings, a URL or a saved view have a camera at its target, at a pole, out of
   *   float32's range, or too far away to see anything
   * @fault Arguments: `place=` moves or scales a file out of float32's range, or so far that its size is
   *   lost
   */
  it('frames a scene that is so far from 0 that its size is lost there', () => {
    const sphere = { center: [1e21, 0, 0], radius: 1 } as const;
    const { camera } = shown({ ...GROUND, sphere, extent: sphere });
    expect(() => camera.orbitCamera).not.toThrow();
    const { min } = camera.controls.distanceRange;
    camera.controls.setPose({ ...camera.controls.pose, distance: min, polar: 0.01 });
    expect(() => camera.orbitCamera).not.toThrow();
  });

  it('goes where stray splats are', () => {
    const { store, camera } = shown({ ...GROUND, extent: { center: [0, 0, 0], radius: 1e7 } });
    const { pose } = camera.controls;
    camera.restore({ ...camera.snapshot(), pose: { ...pose, target: [9e6, 0, 0] } });
    expect(camera.controls.pose.target).toEqual([9e6, 0, 0]);
    expect(store.getState().notice).toBeNull();
  });
});
