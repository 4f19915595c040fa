import { describe, expect, it, vi } from 'vitest';
import { OrbitControls } from './orbit-controls.ts';
import { expectClose, FRONT } from './orbit-pose.fixture.ts';

describe('OrbitControls', () => {
  /** A stand-in for an element of 600 × 400 px, which only the events need, in its middle. */
  function mounted(isMotionReduced = true) {
    const onChange = vi.fn();
    const onDoubleTap = vi.fn();
    const controls = new OrbitControls({ onChange, isMotionReduced: () => isMotionReduced, onDoubleTap });
    controls.fovYDegrees = 90;
    controls.distanceRange = { min: 0.01, max: 1000 };
    controls.setPose(FRONT);
    const element = Object.assign(new EventTarget(), {
      clientWidth: 600,
      clientHeight: 400,
      setPointerCapture: vi.fn(),
      focus: vi.fn(),
      dataset: {},
    });
    const detach = controls.attach(element as unknown as HTMLElement);
    onChange.mockClear();
    const send = (type: string, properties: object) => {
      const event = new Event(type, { cancelable: true });
      element.dispatchEvent(
        Object.assign(
          event,
          { pointerId: 1, pointerType: 'mouse', button: 0, shiftKey: false, ctrlKey: false },
          { offsetX: 300, offsetY: 200 },
          properties,
        ),
      );
      return event;
    };
    return { controls, onChange, onDoubleTap, send, detach };
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

  it('tells where in the image it was tapped twice, without moving', () => {
    const { controls, onDoubleTap, send } = mounted();
    for (const _tap of [1, 2]) {
      const place = { clientX: 160, clientY: 110, offsetX: 150, offsetY: 100 };
      send('pointerdown', place);
      send('pointerup', place);
    }
    expect(onDoubleTap).toHaveBeenCalledExactlyOnceWith(0.25, 0.25);
    expect(controls.pose).toEqual(FRONT);
  });

  it('zooms towards the cursor', () => {
    const { controls, send } = mounted();
    // At the right edge of an image that is as high as twice the distance.
    send('wheel', { deltaY: -1000, deltaMode: 0, offsetX: 600 });
    expect(controls.pose.distance).toBeCloseTo(5);
    expectClose(controls.pose.target, [7.5, 0, 0]);
  });

  it('dollies further per pixel for a trackpad pinch', () => {
    const { controls, send } = mounted();
    send('wheel', { deltaY: -10, deltaMode: 0, ctrlKey: true });
    expect(controls.pose.distance).toBeCloseTo(10 * Math.exp(-0.1));
  });

  it('takes the notch of a wheel with Ctrl as one without', () => {
    const { controls, send } = mounted();
    send('wheel', { deltaY: -100, deltaMode: 0, ctrlKey: true });
    expect(controls.pose.distance).toBeCloseTo(10 * Math.exp(-0.15));
  });

  it('pans and zooms in the area that panels leave free', () => {
    const { controls, send } = mounted();
    controls.covered = { left: 0, right: 0.5, top: 0.25, bottom: 0.25 };
    // In the middle of the area: the target stays.
    send('wheel', { deltaY: -100, deltaMode: 0, offsetX: 150, offsetY: 200 });
    expectClose(controls.pose.target, [0, 0, 0]);
    controls.setPose(FRONT);
    // At its right edge: 1.5 halves of its height.
    send('wheel', { deltaY: -1000, deltaMode: 0, offsetX: 300, offsetY: 200 });
    expectClose(controls.pose.target, [7.5, 0, 0]);
    controls.setPose(FRONT);
    // 200 px high, it shows 20 units in the depth of the target.
    send('pointerdown', { clientX: 0, clientY: 0, button: 2 });
    send('pointermove', { clientX: 50, clientY: 0 });
    expectClose(controls.pose.target, [-5, 0, 0]);
  });

  it('turns, pans, zooms and walks by keys', () => {
    const { controls } = mounted();
    const press = (key: string, shiftKey = false) =>
      controls.handleKey({ key, shiftKey, ctrlKey: false, metaKey: false, altKey: false });
    expect(press('ArrowRight')).toBe(true);
    expect(controls.pose.azimuth).toBeGreaterThan(0);
    controls.reset();
    expect(controls.pose).toEqual(FRONT);
    press('ArrowRight', true);
    expect(controls.pose.target[0]).toBeGreaterThan(0);
    controls.reset();
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
      controls.handleKey({ key: 'w', shiftKey: false, ctrlKey: true, metaKey: false, altKey: false }),
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
