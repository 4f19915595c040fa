import { flightDirection, flown, isFlightKey, turnedInPlace } from '../camera/fly-pose.ts';
import { scale } from '../camera/vec3.ts';
import type { ViewCamera } from '../camera/view-camera.ts';
import type { ViewerStore } from '../state/store.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';

/** Radii of the scene that are flown in a second at speed 1. */
export const RADII_PER_S = 0.4;
/** Shift makes everything so many times as fast. */
const FAST_FACTOR = 4;
/** A key that is only touched flies for so long. */
const STEP_MS = 1000 / 60;
const RADIANS_PER_PX = 0.0025;
/** A mouse wheel's notch is about 100 px: a sixth faster. */
const SPEED_PER_WHEEL_PX = 0.0015;
const SPEED_RANGE = { min: 0.02, max: 50 } as const;

/**
 * Flies through the scene: the mouse looks around, held keys move, the wheel changes the speed.
 * Where the browser gives the pointer away it stays in the image until Escape; elsewhere dragging
 * looks around.
 */
export class Flight {
  readonly #store: ViewerStore;
  readonly #camera: ViewCamera;
  readonly #held = new Set<string>();
  readonly #motion = (elapsedMs: number) => this.#move(elapsedMs);
  #isFast = false;
  #ending: AbortController | null = null;

  constructor(store: ViewerStore, camera: ViewCamera) {
    this.#store = store;
    this.#camera = camera;
  }

  /** Begins to fly over `element`, or ends it. */
  toggle(element: HTMLElement): void {
    if (this.#ending) this.end();
    else this.#begin(element);
  }

  end(): void {
    this.#ending?.abort();
  }

  #begin(element: HTMLElement): void {
    const ending = new AbortController();
    const { signal } = ending;
    this.#ending = ending;
    // In a parallel projection nothing would come nearer.
    this.#camera.setLook({ isOrthographic: false });
    this.#camera.controls.isPaused = true;
    this.#camera.setMotion(this.#motion);
    this.#store.setState({ flightSpeed: 1, isPathPlaying: false });
    // Before everybody else: E and the arrows mean something else there.
    const keys = { signal, capture: true };
    window.addEventListener('keydown', (event) => this.#keyDown(event), keys);
    window.addEventListener('keyup', (event) => this.#keyUp(event), keys);
    window.addEventListener('blur', () => this.#release(), { signal });
    element.addEventListener('pointermove', (event) => this.#look(element, event), { signal });
    element.addEventListener('wheel', (event) => this.#changeSpeed(event), { signal });
    let wasLocked = false;
    const followLock = () => {
      const isLocked = document.pointerLockElement === element;
      if (wasLocked && !isLocked) this.end();
      wasLocked = isLocked;
    };
    document.addEventListener('pointerlockchange', followLock, { signal });
    const unsubscribe = this.#store.subscribe(({ isHelpVisible, scene }, before) => {
      if (isHelpVisible || scene !== before.scene) this.end();
    });
    signal.addEventListener('abort', () => {
      unsubscribe();
      this.#ending = null;
      this.#release();
      this.#camera.controls.isPaused = false;
      this.#camera.setMotion(null);
      this.#store.setState({ flightSpeed: null });
      if (document.pointerLockElement === element) document.exitPointerLock();
    });
    // The keys belong to the image from now on.
    focusByPointer(element);
    void lockPointer(element);
  }

  #keyDown(event: KeyboardEvent): void {
    if (event.key === 'Escape') this.end();
    else if (event.ctrlKey || event.metaKey || event.altKey) return;
    else if (event.key === 'Shift') this.#isFast = true;
    else if (!isFlightKey(event.code)) return;
    else if (!event.repeat) this.#press(event.code);
    event.preventDefault();
    event.stopPropagation();
  }

  /** Moves a step at once: a key may be let go before the next frame. */
  #press(code: string): void {
    this.#held.add(code);
    this.#move(STEP_MS);
  }

  #keyUp(event: KeyboardEvent): void {
    if (event.key === 'Shift') this.#isFast = false;
    this.#held.delete(event.code);
  }

  /** Keys that are let go over another window send no event here. */
  #release(): void {
    this.#held.clear();
    this.#isFast = false;
  }

  #move(elapsedMs: number): boolean {
    const direction = flightDirection(this.#held);
    if (!direction) return false;
    const { controls, subjectRadius } = this.#camera;
    const speed = (this.#store.getState().flightSpeed ?? 0) * (this.#isFast ? FAST_FACTOR : 1);
    const way = (speed * RADII_PER_S * subjectRadius * elapsedMs) / 1000;
    controls.moveTo(flown(controls.pose, scale(direction, way)));
    return true;
  }

  #look(element: HTMLElement, { movementX, movementY, buttons }: PointerEvent): void {
    if (document.pointerLockElement !== element && buttons === 0) return;
    const { controls } = this.#camera;
    controls.moveTo(turnedInPlace(controls.pose, -movementX * RADIANS_PER_PX, -movementY * RADIANS_PER_PX));
  }

  #changeSpeed({ deltaY }: WheelEvent): void {
    const { flightSpeed } = this.#store.getState();
    const speed = (flightSpeed ?? 1) * Math.exp(-deltaY * SPEED_PER_WHEEL_PX);
    this.#store.setState({ flightSpeed: Math.min(SPEED_RANGE.max, Math.max(SPEED_RANGE.min, speed)) });
  }
}

/** Browsers may refuse, e.g. after Escape: dragging looks around then. Old ones have no promise. */
async function lockPointer(element: HTMLElement): Promise<void> {
  await Promise.resolve(element.requestPointerLock?.()).catch(() => {});
}
