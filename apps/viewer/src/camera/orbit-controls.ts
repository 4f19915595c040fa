import {
  type DistanceRange,
  dollied,
  dolliedAt,
  type ImagePoint,
  isClose,
  mixed,
  moved,
  type OrbitPose,
  orbited,
  panned,
  unwound,
} from '../state/orbit-pose.ts';
import { clamp, scale, type Vec3 } from '../state/vec3.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';
import { type Covered, NOTHING_COVERED } from './covered.ts';
import { Tap, type TapEvent, wayPx } from './tap.ts';

/** Longest pause between the taps of a double tap, ms. */
const MAX_PAUSE_MS = 400;
/** Largest distance between the taps: fingers do not hit the same point twice. */
const MAX_APART_PX = 24;

/**
 * Detects double taps of mouse, pen or finger. Some touch screens send no `dblclick`, above all if
 * the page disables zooming.
 */
export class DoubleTap {
  readonly #tap = new Tap();
  #lastTap: TapEvent | null = null;

  /** @param isPrimary whether it is the only pointer, pressed by its main button. */
  pointerDown(event: TapEvent, isPrimary: boolean): void {
    this.#tap.pointerDown(event, isPrimary);
    if (!isPrimary) this.#lastTap = null;
  }

  /** Returns whether releasing the pointer completes a double tap. */
  pointerUp(event: TapEvent): boolean {
    const last = this.#lastTap;
    this.#lastTap = null;
    if (!this.#tap.pointerUp(event)) return false;
    const isSecond =
      last !== null && event.timeStamp - last.timeStamp < MAX_PAUSE_MS && wayPx(last, event) < MAX_APART_PX;
    // A third tap starts a new double tap.
    if (!isSecond) this.#lastTap = event;
    return isSecond;
  }
}

/** A drag over the element's whole height turns by half a circle. */
const ORBIT_RADIANS_PER_HEIGHT = Math.PI;
const KEY_ORBIT_RADIANS = Math.PI / 36;
/** Fraction of the element's height by which one key press pans. */
const KEY_PAN_HEIGHTS = 0.05;
const KEY_DOLLY_FACTOR = 1.1;
/** Fraction of the distance to the target by which one key press moves camera and target. */
const KEY_MOVE_DISTANCES = 0.06;
/** A notch of a mouse wheel, about 100 px, moves a seventh nearer. */
const WHEEL_DOLLY_PER_PX = 0.0015;
/** Browsers report a trackpad pinch as a wheel with Ctrl and small deltas. */
const PINCH_DOLLY_PER_PX = 0.01;
/** With Ctrl, a larger delta is the notch of a mouse wheel. */
const MOST_PINCH_PX = 50;
const WHEEL_LINE_PX = 16;
/** Time constant of keyboard and wheel steps; short, so that they feel direct. */
const DAMPING_MS = 55;

export interface OrbitControlsOptions {
  /** Called when the pose has changed or will change: draw a frame. */
  readonly onChange: () => void;
  /** Whether steps must not be animated, e.g. by `prefers-reduced-motion`; called at each step. */
  readonly isMotionReduced?: () => boolean;
  /**
   * Called after a double tap; `xPart` and `yPart` are fractions of the image from its top left.
   */
  readonly onDoubleTap?: (xPart: number, yPart: number) => void;
}

interface Pointer {
  readonly x: number;
  readonly y: number;
}

/**
 * Orbit, pan and dolly around a target by mouse, touch, trackpad and keyboard. Handles the events
 * of a DOM element and is independent of the renderer: the caller draws `lookAt(pose)`.
 */
export class OrbitControls {
  /** Vertical field of view for the free area, degrees. */
  fovYDegrees = 60;
  /** Fractions of the picture outside of the free area, whose centre shows the target. */
  covered = NOTHING_COVERED;
  distanceRange: DistanceRange = { min: 1e-3, max: 1e5 };
  /** Whether pointers and wheel are ignored because another tool uses them. */
  isPaused = false;

  readonly #onChange: () => void;
  readonly #isMotionReduced: () => boolean;
  readonly #onDoubleTap: (xPart: number, yPart: number) => void;
  readonly #doubleTap = new DoubleTap();
  readonly #pointers = new Map<number, Pointer>();
  #shown: OrbitPose = { target: [0, 0, 0], distance: 1, azimuth: 0, polar: Math.PI / 2, up: [0, 1, 0] };
  #goal: OrbitPose = this.#shown;
  #home: OrbitPose = this.#shown;
  /** Height of the element. */
  #heightPx = 1;
  #isPanning = false;
  #gestureScale = 1;

  constructor({ onChange, isMotionReduced = () => false, onDoubleTap = () => {} }: OrbitControlsOptions) {
    this.#onChange = onChange;
    this.#onDoubleTap = onDoubleTap;
    this.#isMotionReduced = isMotionReduced;
  }

  /** The pose to draw, which approaches the goal. */
  get pose(): OrbitPose {
    return this.#shown;
  }

  /** The pose that `reset` returns to. */
  get home(): OrbitPose {
    return this.#home;
  }

  /** Whether the pose to draw equals home, ignoring whole turns. */
  get isHome(): boolean {
    return isClose(unwound(this.#shown, this.#home.azimuth), this.#home);
  }

  /** Jumps to `pose`. */
  setPose(pose: OrbitPose, home: OrbitPose = pose): void {
    this.#home = home;
    this.#shown = pose;
    this.#goal = pose;
    this.#onChange();
  }

  /** Returns to home. */
  reset(): void {
    this.glideTo(this.#home);
  }

  /** Glides to `pose` by the shorter way round. */
  glideTo(pose: OrbitPose): void {
    const isSameUp = pose.up.every((value, axis) => value === this.#shown.up[axis]);
    if (isSameUp) this.#step(unwound(pose, this.#shown.azimuth));
    else this.setPose(pose, this.#home);
  }

  /** Sets the pose at once, without gliding, for callers that animate the camera themselves. */
  moveTo(pose: OrbitPose): void {
    this.#goal = pose;
    this.#shown = pose;
    this.#onChange();
  }

  /** Glides `elapsedMs` further towards the goal; returns whether another frame is needed. */
  update(elapsedMs: number): boolean {
    if (this.#shown === this.#goal) return false;
    const next = mixed(this.#shown, this.#goal, 1 - Math.exp(-elapsedMs / DAMPING_MS));
    this.#shown = isClose(next, this.#goal) ? this.#goal : next;
    return this.#shown !== this.#goal;
  }

  /**
   * Listens to `element`, which needs `touch-action: none`. The caller passes keys to `handleKey`.
   * Returns a function that stops listening.
   */
  attach(element: HTMLElement): () => void {
    const listeners = new AbortController();
    const { signal } = listeners;
    const listen = <E extends Event>(type: string, handler: (event: E) => void) =>
      element.addEventListener(type, handler as (event: Event) => void, { signal, passive: false });
    listen<PointerEvent>('pointerdown', (event) => this.#pointerDown(element, event));
    listen<PointerEvent>('pointermove', (event) => this.#pointerMove(event));
    listen<PointerEvent>('pointerup', (event) => this.#pointerUp(element, event));
    listen<PointerEvent>('pointercancel', (event) => this.#pointers.delete(event.pointerId));
    listen<PointerEvent>('lostpointercapture', (event) => this.#pointers.delete(event.pointerId));
    listen<WheelEvent>('wheel', (event) => this.#wheel(element, event));
    listen<Event>('contextmenu', (event) => event.preventDefault());
    // Safari reports a trackpad pinch by events of its own, with a scale relative to the gesture's
    // start.
    listen<Event>('gesturestart', (event) => {
      event.preventDefault();
      this.#gestureScale = 1;
    });
    listen<Event & { scale: number }>('gesturechange', (event) => {
      event.preventDefault();
      // On touch screens, the same fingers also send pointer events.
      if (this.#pointers.size === 0)
        this.moveTo(dollied(this.#goal, this.#gestureScale / event.scale, this.distanceRange));
      this.#gestureScale = event.scale;
    });
    return () => {
      listeners.abort();
      this.#pointers.clear();
    };
  }

  /** Moves by a pressed key; returns whether the key has a function here. */
  handleKey(event: Pick<KeyboardEvent, 'key' | 'shiftKey' | 'ctrlKey' | 'metaKey' | 'altKey'>): boolean {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    const next = this.#poseAfterKey(event.key, event.shiftKey);
    if (!next) return false;
    this.#step(next);
    return true;
  }

  #poseAfterKey(key: string, isShift: boolean): OrbitPose | null {
    const goal = this.#goal;
    const arrow = ARROWS[key];
    if (arrow) {
      const [right, down] = arrow;
      if (!isShift) return orbited(goal, right * KEY_ORBIT_RADIANS, down * KEY_ORBIT_RADIANS);
      // The camera, not the scene, moves in the direction of the arrow.
      return panned(goal, -right * KEY_PAN_HEIGHTS, -down * KEY_PAN_HEIGHTS, 1, this.fovYDegrees);
    }
    const step = MOVES[key.toLowerCase()];
    if (step) return moved(goal, scale(step, goal.distance * KEY_MOVE_DISTANCES));
    if (key === '+' || key === '=') return dollied(goal, 1 / KEY_DOLLY_FACTOR, this.distanceRange);
    if (key === '-' || key === '_') return dollied(goal, KEY_DOLLY_FACTOR, this.distanceRange);
    return null;
  }

  #pointerDown(element: HTMLElement, event: PointerEvent): void {
    // A third finger has no function and would make the image jump.
    if (this.isPaused || this.#pointers.size === 2) return;
    if (event.pointerType === 'mouse' && event.button > 2) return;
    const isAlone = this.#pointers.size === 0;
    this.#doubleTap.pointerDown(event, isAlone && event.button === 0 && !event.shiftKey);
    if (isAlone) this.#isPanning = event.button !== 0 || event.shiftKey;
    this.#heightPx = Math.max(1, element.clientHeight);
    this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    element.setPointerCapture(event.pointerId);
    // Prevents scrolling by the middle button, and with it focus: hence the call below.
    event.preventDefault();
    focusByPointer(element);
  }

  #pointerUp(element: HTMLElement, event: PointerEvent): void {
    this.#pointers.delete(event.pointerId);
    if (this.#doubleTap.pointerUp(event))
      this.#onDoubleTap(event.offsetX / element.clientWidth, event.offsetY / element.clientHeight);
  }

  #pointerMove(event: PointerEvent): void {
    const before = [...this.#pointers.values()];
    const last = this.#pointers.get(event.pointerId);
    if (!last) return;
    this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const dx = event.clientX - last.x;
    const dy = event.clientY - last.y;
    const freePx = this.#heightPx * (1 - this.covered.top - this.covered.bottom);
    if (before.length === 2) {
      const after = [...this.#pointers.values()];
      const factor = spread(before) / spread(after);
      // The midpoint of two fingers moves half as far as one of them.
      const pose = panned(this.#goal, dx / 2, dy / 2, freePx, this.fovYDegrees);
      this.moveTo(dollied(pose, Number.isFinite(factor) && factor > 0 ? factor : 1, this.distanceRange));
    } else if (this.#isPanning) {
      this.moveTo(panned(this.#goal, dx, dy, freePx, this.fovYDegrees));
    } else {
      const radiansPerPx = ORBIT_RADIANS_PER_HEIGHT / this.#heightPx;
      this.moveTo(orbited(this.#goal, -dx * radiansPerPx, -dy * radiansPerPx));
    }
  }

  #wheel(element: HTMLElement, event: WheelEvent): void {
    event.preventDefault();
    if (this.isPaused) return;
    const deltaPx = event.deltaY * ([1, WHEEL_LINE_PX, element.clientHeight][event.deltaMode] ?? 1);
    const isPinch = event.ctrlKey && Math.abs(deltaPx) < MOST_PINCH_PX;
    // Some mice send several notches at once; more than a factor of two per event disorients.
    const exponent = clamp(
      deltaPx * (isPinch ? PINCH_DOLLY_PER_PX : WHEEL_DOLLY_PER_PX),
      -Math.LN2,
      Math.LN2,
    );
    const factor = Math.exp(exponent);
    const pose = dolliedAt(
      this.#goal,
      factor,
      this.distanceRange,
      freePoint(element, event, this.covered),
      this.fovYDegrees,
    );
    if (isPinch) this.moveTo(pose);
    else this.#step(pose);
  }

  /** A discrete step, which glides unless motion is reduced. */
  #step(pose: OrbitPose): void {
    this.#goal = pose;
    if (this.#isMotionReduced()) this.#shown = pose;
    this.#onChange();
  }
}

/** Right and down, by arrow key. */
export const ARROWS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** Right, up and back. */
const MOVES: Readonly<Record<string, Vec3>> = {
  w: [0, 0, -1],
  s: [0, 0, 1],
  a: [-1, 0, 0],
  d: [1, 0, 0],
  pagedown: [0, -1, 0],
  pageup: [0, 1, 0],
};

/** Position of an event on `element`, relative to the centre of the free area. */
function freePoint(
  { clientWidth, clientHeight }: HTMLElement,
  { offsetX, offsetY }: MouseEvent,
  { left, right, top, bottom }: Covered,
): ImagePoint {
  const heightPx = Math.max(1, clientHeight);
  const xMiddle = (clientWidth * (1 + left - right)) / 2;
  const yMiddle = (heightPx * (1 + top - bottom)) / 2;
  const halfHeight = (heightPx * (1 - top - bottom)) / 2;
  return { right: (offsetX - xMiddle) / halfHeight, up: (yMiddle - offsetY) / halfHeight };
}

function spread([a, b]: readonly Pointer[]): number {
  return Math.hypot(a.x - b.x, a.y - b.y);
}
