import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ViewCamera } from '../camera/view-camera.ts';
import type { Viewer } from '../engine/viewer.ts';
import { cameraAxes } from '../state/orbit-pose.ts';
import type { SceneSummary } from '../state/scene.ts';
import { createViewerStore } from '../state/store.ts';
import { dot, subtract } from '../state/vec3.ts';
import { toggleFlight } from './flight.ts';

/** Stand-ins for the browser's; pointers can be locked where `isLockable`. */
function started(isLockable: boolean) {
  const [fakeWindow, fakeDocument] = [new EventTarget(), new EventTarget()];
  const lock = (target: unknown) => {
    Object.assign(fakeDocument, { pointerLockElement: target });
    fakeDocument.dispatchEvent(new Event('pointerlockchange'));
  };
  Object.assign(fakeDocument, { pointerLockElement: null, exitPointerLock: () => lock(null) });
  vi.stubGlobal('window', fakeWindow);
  vi.stubGlobal('document', fakeDocument);
  vi.stubGlobal('HTMLElement', class {});
  const element = Object.assign(new EventTarget(), {
    dataset: {},
    focus: vi.fn(),
    requestPointerLock: async () => {
      if (!isLockable) throw new Error('Refused.');
      lock(element);
    },
  }) as unknown as HTMLElement;
  const store = createViewerStore();
  store.setState({ widthPx: 300, heightPx: 200, scene: {} as SceneSummary });
  const camera = new ViewCamera(store, { onChange: () => {} });
  const sphere = { center: [0, 0, 0], radius: 10 } as const;
  const plain = { firstView: null, ownCameras: null, isUpsideDown: false, framing: null, detail: null };
  camera.follow({ sphere, extent: sphere, ...plain });
  camera.showFirstView();
  const toggle = () => toggleFlight({ camera, canvas: element, scenes: { newest: {} } } as Viewer, store);
  toggle();
  const send = (target: EventTarget, type: string, properties: object) => {
    const event = Object.assign(new Event(type, { cancelable: true }), properties);
    target.dispatchEvent(event);
    return event;
  };
  const key = (type: string, code: string, shown = code) => send(fakeWindow, type, { code, key: shown });
  return { store, camera, toggle, element, lock, send, key };
}

describe('flight', () => {
  beforeEach(() => void vi.unstubAllGlobals());
  afterEach(() => void vi.unstubAllGlobals());

  it('moves while keys are held, as fast as the scene is large, faster with Shift', () => {
    const { camera, key } = started(false);
    const distanceMoved = () => {
      const before = camera.controls.pose.target;
      const goesOn = camera.update(1000);
      const after = camera.controls.pose.target;
      return goesOn ? Math.hypot(...after.map((value, axis) => value - before[axis])) : null;
    };
    expect(distanceMoved()).toBeNull();
    expect(key('keydown', 'KeyW').defaultPrevented).toBe(true);
    expect(distanceMoved()).toBeCloseTo(4);
    key('keydown', 'ShiftLeft', 'Shift');
    expect(distanceMoved()).toBeCloseTo(16);
    key('keyup', 'KeyW');
    expect(distanceMoved()).toBeNull();
  });

  it('looks around by dragging, or without where the pointer is locked', async () => {
    const dragged = started(false);
    const { azimuth } = dragged.camera.controls.pose;
    dragged.send(dragged.element, 'pointermove', {
      movementX: 10,
      movementY: 0,
      buttons: 0,
      isPrimary: true,
    });
    expect(dragged.camera.controls.pose.azimuth).toBe(azimuth);
    dragged.send(dragged.element, 'pointermove', {
      movementX: 10,
      movementY: 0,
      buttons: 1,
      isPrimary: true,
    });
    expect(dragged.camera.controls.pose.azimuth).toBeCloseTo(azimuth - 0.025);
    dragged.toggle();
    const locked = started(true);
    await Promise.resolve();
    locked.send(locked.element, 'pointermove', { movementX: 10, movementY: 0, buttons: 0, isPrimary: true });
    expect(locked.camera.controls.pose.azimuth).toBeCloseTo(azimuth - 0.025);
  });

  it('looks around by a finger, and moves ahead while there is a second one', () => {
    const { camera, element, send } = started(false);
    const { azimuth, target } = camera.controls.pose;
    const second = { pointerType: 'touch', isPrimary: false, movementX: 10, movementY: 0, buttons: 1 };
    send(element, 'pointerdown', second);
    send(element, 'pointermove', second);
    expect(camera.update(1000)).toBe(true);
    expect(camera.controls.pose.azimuth).toBe(azimuth);
    expect(camera.controls.pose.target).not.toEqual(target);
    send(window, 'pointerup', second);
    expect(camera.update(1000)).toBe(false);
  });

  it('goes where the sticks of a gamepad point, as long as they do', () => {
    const { camera } = started(false);
    const { azimuth } = camera.controls.pose;
    camera.steering?.({ left: [0, -1], right: [1, 0], leftTrigger: 0, rightTrigger: 0 }, 0.5);
    const { pose } = camera.controls;
    expect(pose.azimuth).toBeCloseTo(azimuth - 1);
    expect(camera.update(1000)).toBe(true);
    const way = subtract(camera.controls.pose.target, pose.target);
    expect(dot(way, cameraAxes(pose).back)).toBeCloseTo(-4);
    expect(camera.update(1000)).toBe(false);
  });

  it('changes its speed by the wheel, within limits', () => {
    const { store, element, send } = started(false);
    send(element, 'wheel', { deltaY: -100 });
    const speed = () => (store.getState().travelling as { speed: number }).speed;
    expect(speed()).toBeCloseTo(Math.exp(0.15));
    send(element, 'wheel', { deltaY: 1e6 });
    expect(speed()).toBe(0.02);
  });

  it.each([
    ['Escape', ({ key }: ReturnType<typeof started>) => key('keydown', 'Escape')],
    ['the browser taking the pointer back', ({ lock }: ReturnType<typeof started>) => lock(null)],
    ['another scene', ({ store }: ReturnType<typeof started>) => store.setState({ scene: null })],
    ['its own button', ({ toggle }: ReturnType<typeof started>) => toggle()],
  ])('ends by %s, and gives everything back', async (_name, end) => {
    const all = started(true);
    const { store, camera, key } = all;
    await Promise.resolve();
    expect(camera.controls.isPaused).toBe(true);
    key('keydown', 'KeyW');
    end(all);
    expect(store.getState().travelling).toBeNull();
    expect(camera.controls.isPaused).toBe(false);
    expect(camera.update(16)).toBe(false);
    expect(document.pointerLockElement).toBeNull();
    expect(key('keydown', 'KeyW').defaultPrevented).toBe(false);
  });
});
