import fc from 'fast-check';
import { describe, expect, it, vi } from 'vitest';
import {
  cameraAxes,
  dollied,
  lookAt,
  mixed,
  moved,
  OrbitControls,
  type OrbitPose,
  orbited,
  panned,
  poseFromLookAt,
  unwound,
  type Vec3,
} from './orbit-controls.ts';

const FRONT: OrbitPose = { target: [0, 0, 0], distance: 10, azimuth: 0, polar: Math.PI / 2, up: [0, 1, 0] };

const coordinate = fc.double({ min: -100, max: 100, noNaN: true });
const point = fc.tuple(coordinate, coordinate, coordinate);
const direction = point
  .filter((v) => Math.hypot(...v) > 1)
  .map((v): Vec3 => {
    const length = Math.hypot(...v);
    return [v[0] / length, v[1] / length, v[2] / length];
  });
const pose: fc.Arbitrary<OrbitPose> = fc.record({
  target: point,
  distance: fc.double({ min: 0.1, max: 1000, noNaN: true }),
  azimuth: fc.double({ min: -3.1, max: 3.1, noNaN: true }),
  polar: fc.double({ min: 0.02, max: 3.12, noNaN: true }),
  up: direction,
});

function expectClose(actual: Vec3, expected: Vec3, tolerance = 1e-9) {
  const error = Math.hypot(actual[0] - expected[0], actual[1] - expected[1], actual[2] - expected[2]);
  expect(error, `[${actual}] against [${expected}]`).toBeLessThan(tolerance);
}

describe('poses', () => {
  it('has the camera on +z of a target that is seen from the front, with x to the right', () => {
    expectClose(lookAt(FRONT).position, [0, 0, 10]);
    const { right, above } = cameraAxes(FRONT);
    expectClose(right, [1, 0, 0]);
    expectClose(above, [0, 1, 0]);
  });

  it('is recovered from the camera that it gives, for any up', () => {
    fc.assert(
      fc.property(pose, (before) => {
        const after = poseFromLookAt(lookAt(before));
        expect(after.distance / before.distance).toBeCloseTo(1, 9);
        expect(after.azimuth).toBeCloseTo(before.azimuth, 6);
        expect(after.polar).toBeCloseTo(before.polar, 6);
      }),
    );
  });

  it('has orthonormal camera axes, right-handed', () => {
    fc.assert(
      fc.property(pose, (any) => {
        const { right, above, back } = cameraAxes(any);
        for (const axis of [right, above, back]) expect(Math.hypot(...axis)).toBeCloseTo(1, 9);
        expectClose(back, [
          right[1] * above[2] - right[2] * above[1],
          right[2] * above[0] - right[0] * above[2],
          right[0] * above[1] - right[1] * above[0],
        ]);
      }),
    );
  });

  it('refuses a camera on its target', () => {
    expect(() => poseFromLookAt({ position: [1, 2, 3], target: [1, 2, 3], up: [0, 1, 0] })).toThrow(
      RangeError,
    );
  });

  it('orbits to the side that the arrow means and stops before the poles', () => {
    expect(lookAt(orbited(FRONT, Math.PI / 2, 0)).position[0]).toBeCloseTo(10);
    expect(lookAt(orbited(FRONT, 0, -0.5)).position[1]).toBeGreaterThan(0);
    expect(orbited(FRONT, 0, -9).polar).toBeGreaterThan(0);
    expect(orbited(FRONT, 0, 9).polar).toBeLessThan(Math.PI);
  });

  it('pans so that the target follows the pointer exactly', () => {
    // At 90° and distance 10 the picture is 20 units high: 100 px of 400 are 5 units.
    expectClose(panned(FRONT, 100, 0, 400, 90).target, [-5, 0, 0]);
    expectClose(panned(FRONT, 0, 100, 400, 90).target, [0, 5, 0]);
  });

  it('moves along the camera’s own axes', () => {
    const side = orbited(FRONT, Math.PI / 2, 0);
    expectClose(moved(side, [0, 0, -2]).target, [-2, 0, 0]);
  });

  it('keeps the distance within its range', () => {
    const range = { min: 1, max: 20 };
    expect(dollied(FRONT, 0.5, range).distance).toBe(5);
    expect(dollied(FRONT, 0.01, range).distance).toBe(1);
    expect(dollied(FRONT, 100, range).distance).toBe(20);
  });

  it('mixes from one pose to the other', () => {
    const to = { ...FRONT, azimuth: 1, distance: 40 };
    expect(mixed(FRONT, to, 0)).toEqual(FRONT);
    expect(mixed(FRONT, to, 1)).toEqual(to);
    expect(mixed(FRONT, to, 0.5).distance).toBeCloseTo(20);
  });

  it('unwinds to the nearest equal azimuth', () => {
    expect(unwound({ ...FRONT, azimuth: 0.1 }, 4 * Math.PI).azimuth).toBeCloseTo(4 * Math.PI + 0.1);
  });
});

describe('OrbitControls', () => {
  /** A stand-in for an element of 400 px height, which only the events need. */
  function mounted(isMotionReduced = true) {
    const onChange = vi.fn();
    const controls = new OrbitControls({ onChange, isMotionReduced: () => isMotionReduced });
    controls.fovYDegrees = 90;
    controls.distanceRange = { min: 0.01, max: 1000 };
    controls.setPose(FRONT);
    const element = Object.assign(new EventTarget(), {
      clientHeight: 400,
      setPointerCapture: vi.fn(),
      focus: vi.fn(),
    });
    const detach = controls.attach(element as unknown as HTMLElement);
    onChange.mockClear();
    const send = (type: string, properties: object) => {
      const event = new Event(type, { cancelable: true });
      element.dispatchEvent(
        Object.assign(
          event,
          { pointerId: 1, pointerType: 'mouse', button: 0, shiftKey: false, ctrlKey: false },
          properties,
        ),
      );
      return event;
    };
    return { controls, onChange, send, detach };
  }

  it('orbits by a left drag: the whole height is half a turn', () => {
    const { controls, send, onChange } = mounted();
    send('pointerdown', { clientX: 100, clientY: 100 });
    send('pointermove', { clientX: 300, clientY: 100 });
    expect(controls.pose.azimuth).toBeCloseTo(-Math.PI / 2);
    expect(onChange).toHaveBeenCalledOnce();
    send('pointerup', {});
    send('pointermove', { clientX: 0, clientY: 0 });
    expect(controls.pose.azimuth).toBeCloseTo(-Math.PI / 2);
  });

  it.each([
    ['right', { button: 2 }],
    ['middle', { button: 1 }],
    ['Shift and left', { shiftKey: true }],
  ])('pans by a %s drag', (_name, properties) => {
    const { controls, send } = mounted();
    send('pointerdown', { clientX: 0, clientY: 0, ...properties });
    send('pointermove', { clientX: 100, clientY: 0 });
    expectClose(controls.pose.target, [-5, 0, 0]);
    expect(controls.pose.azimuth).toBe(0);
  });

  it('knows when it is home, after whole turns too', () => {
    const { controls } = mounted();
    expect(controls.isHome).toBe(true);
    for (let step = 0; step < 72; step++) {
      controls.handleKey({
        key: 'ArrowRight',
        shiftKey: false,
        ctrlKey: false,
        metaKey: false,
        altKey: false,
      });
      expect(controls.isHome).toBe(step === 71);
    }
  });

  it('follows a hand at once even where steps glide', () => {
    const { controls, send } = mounted(false);
    send('pointerdown', { clientX: 100, clientY: 100 });
    send('pointermove', { clientX: 300, clientY: 100 });
    expect(controls.pose.azimuth).toBeCloseTo(-Math.PI / 2);
    expect(controls.update(16)).toBe(false);
  });

  it('pinches and pans with two fingers, and orbits on with the one that stays', () => {
    const { controls, send } = mounted();
    const touch = { pointerType: 'touch' };
    send('pointerdown', { ...touch, pointerId: 1, clientX: 100, clientY: 100 });
    send('pointerdown', { ...touch, pointerId: 2, clientX: 200, clientY: 100 });
    send('pointermove', { ...touch, pointerId: 2, clientX: 300, clientY: 100 });
    expect(controls.pose.distance).toBeCloseTo(5);
    expectClose(controls.pose.target, [-2.5, 0, 0]);
    send('pointerup', { ...touch, pointerId: 1 });
    send('pointermove', { ...touch, pointerId: 2, clientX: 300, clientY: 140 });
    expect(controls.pose.polar).toBeCloseTo(Math.PI / 2 - Math.PI / 10);
    expect(controls.pose.distance).toBeCloseTo(5);
  });

  it('does not move by itself when a finger is put down or lifted', () => {
    const { controls, send, onChange } = mounted();
    const touch = { pointerType: 'touch' };
    send('pointerdown', { ...touch, pointerId: 1, clientX: 0, clientY: 0 });
    send('pointerdown', { ...touch, pointerId: 2, clientX: 0, clientY: 0 });
    send('pointerdown', { ...touch, pointerId: 3, clientX: 50, clientY: 50 });
    send('pointermove', { ...touch, pointerId: 3, clientX: 90, clientY: 90 });
    send('pointerup', { ...touch, pointerId: 2 });
    expect(onChange).not.toHaveBeenCalled();
    expect(controls.pose).toEqual(FRONT);
  });

  it('dollies by wheel in pixels and in lines, in and out again, and keeps the page still', () => {
    const { controls, send } = mounted();
    expect(send('wheel', { deltaY: -96, deltaMode: 0 }).defaultPrevented).toBe(true);
    const near = controls.pose.distance;
    expect(near).toBeLessThan(10);
    send('wheel', { deltaY: 6, deltaMode: 1 });
    expect(controls.pose.distance).toBeCloseTo(10);
  });

  it('dollies further per pixel for a trackpad pinch', () => {
    const { controls, send } = mounted();
    send('wheel', { deltaY: -10, deltaMode: 0, ctrlKey: true });
    expect(controls.pose.distance).toBeCloseTo(10 * Math.exp(-0.1));
  });

  it('turns, pans, zooms, walks and resets by keys', () => {
    const { controls } = mounted();
    const press = (key: string, shiftKey = false) =>
      controls.handleKey({ key, shiftKey, ctrlKey: false, metaKey: false, altKey: false });
    expect(press('ArrowRight')).toBe(true);
    expect(controls.pose.azimuth).toBeGreaterThan(0);
    press('Home');
    expect(controls.pose).toEqual(FRONT);
    press('ArrowRight', true);
    expect(controls.pose.target[0]).toBeGreaterThan(0);
    press('r');
    press('+');
    expect(controls.pose.distance).toBeLessThan(10);
    press('-');
    expect(controls.pose.distance).toBeCloseTo(10);
    press('w');
    expect(controls.pose.target[2]).toBeLessThan(0);
    press('PageUp');
    expect(controls.pose.target[1]).toBeGreaterThan(0);
    expect(press('x')).toBe(false);
    expect(
      controls.handleKey({ key: 'r', shiftKey: false, ctrlKey: true, metaKey: false, altKey: false }),
    ).toBe(false);
  });

  it('glides to a step’s goal and arrives', () => {
    const { controls } = mounted(false);
    controls.handleKey({ key: '-', shiftKey: false, ctrlKey: false, metaKey: false, altKey: false });
    expect(controls.pose.distance).toBe(10);
    let frames = 0;
    while (controls.update(16)) frames++;
    expect(controls.pose.distance).toBeCloseTo(11);
    expect(frames).toBeGreaterThan(5);
    expect(frames).toBeLessThan(60);
    expect(controls.update(16)).toBe(false);
  });

  it('resets by the shorter way round', () => {
    const { controls } = mounted();
    controls.glideTo({ ...FRONT, azimuth: 11 });
    controls.reset();
    expect(Math.abs(controls.pose.azimuth % (2 * Math.PI))).toBeCloseTo(0);
  });

  it('hears nothing after it was detached', () => {
    const { controls, send, detach } = mounted();
    detach();
    send('wheel', { deltaY: 100, deltaMode: 0 });
    expect(controls.pose).toEqual(FRONT);
  });
});
