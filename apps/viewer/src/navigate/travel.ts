import { flightDirection, isFlightKey, turnedInPlace } from '../camera/fly-pose.ts';
import { directionOf, type GamepadSticks, lookedBy } from '../camera/gamepad-motion.ts';
import type { ViewCamera } from '../camera/view-camera.ts';
import type { Travelling } from '../state/camera.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import type { Vec3 } from '../state/vec3.ts';
import { keyScope, mayMoveCamera } from '../ui/key-scope.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';

/** Time for which a key that is only tapped moves, ms. */
const STEP_MS = 1000 / 60;
const RADIANS_PER_PX = 0.0025;
/** A notch of a mouse wheel, about 100 px, changes the value by a sixth. */
const FACTOR_PER_WHEEL_PX = 0.0015;
/** A second finger acts like this key, which moves ahead. */
const FINGER_KEY = 'KeyW';

/** The parts of travelling in which Fly and Walk differ. */
export interface TravelMode {
  readonly begun: Travelling;
  /**
   * Moves by one step.
   *
   * @param direction right, up and ahead, up to length 1; null for no movement.
   * @returns whether another frame is needed.
   */
  move(direction: Vec3 | null, isFast: boolean, elapsedMs: number): boolean;
  /** Multiplies the mode's number by `factor`; called by the wheel. */
  scale(factor: number): void;
  /** Whether the state change ends travelling. */
  isOver?(state: ViewerState, before: ViewerState): boolean;
}

/**
 * Moves through the scene until it ends. The mouse looks around, held keys move, the wheel changes
 * the mode's number. If the browser grants pointer lock, the pointer is captured until Escape;
 * otherwise dragging looks around. On touch screens, one finger looks around and a second one moves
 * ahead.
 */
export class Travel {
  readonly #camera: ViewCamera;
  readonly #mode: TravelMode;
  readonly #held = new Set<string>();
  readonly #ending = new AbortController();
  #isFast = false;
  /** Direction of a gamepad's stick for the next frame. */
  #stick: Vec3 | null = null;

  /** Begins travelling; `element` receives pointer and wheel events. */
  constructor(store: ViewerStore, camera: ViewCamera, element: HTMLElement, mode: TravelMode) {
    this.#camera = camera;
    this.#mode = mode;
    const { signal } = this.#ending;
    // In a parallel projection nothing would come nearer.
    camera.setLook({ isOrthographic: false });
    camera.controls.isPaused = true;
    camera.setMotion((elapsedMs) => this.#move(elapsedMs));
    camera.steering = (sticks, elapsedS) => this.#steer(sticks, elapsedS);
    store.setState({ travelling: mode.begun, isPathPlaying: false });
    // Captured before other listeners, for which E and the arrows have another meaning.
    const keys = { signal, capture: true };
    window.addEventListener('keydown', (event) => this.#keyDown(event), keys);
    window.addEventListener('keyup', (event) => this.#keyUp(event), keys);
    window.addEventListener('blur', () => this.#release(), { signal });
    element.addEventListener('pointermove', (event) => this.#look(element, event), { signal });
    element.addEventListener('pointerdown', (event) => this.#pointerDown(element, event), { signal });
    for (const type of ['pointerup', 'pointercancel'] as const)
      window.addEventListener(type, (event) => !event.isPrimary && this.#held.delete(FINGER_KEY), { signal });
    element.addEventListener('wheel', ({ deltaY }) => mode.scale(Math.exp(-deltaY * FACTOR_PER_WHEEL_PX)), {
      signal,
    });
    let wasLocked = false;
    const followLock = () => {
      const isLocked = document.pointerLockElement === element;
      if (wasLocked && !isLocked) this.#ending.abort();
      wasLocked = isLocked;
    };
    document.addEventListener('pointerlockchange', followLock, { signal });
    const unsubscribe = store.subscribe((state, before) => {
      const isOver = state.isHelpVisible || state.isPathPlaying || state.scene !== before.scene;
      if (isOver || state.travelling === null || mode.isOver?.(state, before)) this.#ending.abort();
      else if (state.travelling !== before.travelling) this.#move(0);
    });
    signal.addEventListener('abort', () => {
      unsubscribe();
      this.#release();
      camera.controls.isPaused = false;
      camera.setMotion(null);
      camera.steering = null;
      store.setState({ travelling: null });
      if (document.pointerLockElement === element) document.exitPointerLock();
    });
    // Gives the image the keyboard focus.
    focusByPointer(element);
    void lockPointer(element);
  }

  #keyDown(event: KeyboardEvent): void {
    const { key, code, target } = event;
    const scope = keyScope(target);
    if (key === 'Escape') this.#ending.abort();
    else if (event.ctrlKey || event.metaKey || event.altKey || scope === 'text' || scope === 'open list')
      return;
    else if (key === 'Shift') this.#isFast = true;
    else if (!isFlightKey(code) || !mayMoveCamera(scope, key)) return;
    else if (!event.repeat) this.#press(code);
    event.preventDefault();
    event.stopPropagation();
  }

  /** Moves one step at once: the key may be released before the next frame. */
  #press(code: string): void {
    this.#held.add(code);
    this.#move(STEP_MS);
  }

  #keyUp(event: KeyboardEvent): void {
    if (event.key === 'Shift') this.#isFast = false;
    this.#held.delete(event.code);
  }

  /** Releases all keys: a key released over another window sends no event here. */
  #release(): void {
    this.#held.clear();
    this.#isFast = false;
  }

  #move(elapsedMs: number): boolean {
    const direction = flightDirection(this.#held) ?? this.#stick;
    this.#stick = null;
    return this.#mode.move(direction, this.#isFast, elapsedMs);
  }

  #steer(sticks: GamepadSticks, elapsedS: number): void {
    this.#stick = directionOf(sticks);
    const { controls } = this.#camera;
    controls.moveTo(lookedBy(controls.pose, sticks, elapsedS));
  }

  #pointerDown(element: HTMLElement, { pointerType, isPrimary }: PointerEvent): void {
    if (pointerType === 'touch' && !isPrimary) this.#press(FINGER_KEY);
    // Pointer lock may have been refused because the key press was too long ago.
    else if (pointerType === 'mouse' && document.pointerLockElement !== element) void lockPointer(element);
  }

  #look(element: HTMLElement, { movementX, movementY, buttons, isPrimary }: PointerEvent): void {
    if (!isPrimary || (document.pointerLockElement !== element && buttons === 0)) return;
    const { controls } = this.#camera;
    controls.moveTo(turnedInPlace(controls.pose, -movementX * RADIANS_PER_PX, -movementY * RADIANS_PER_PX));
  }
}

/** Old browsers return no promise. */
async function lockPointer(element: HTMLElement): Promise<void> {
  // Browsers may refuse pointer lock, e.g. after Escape: dragging then looks around.
  await Promise.resolve(element.requestPointerLock?.()).catch(() => {});
}
