import type { ViewCamera } from '../camera/view-camera.ts';
import { cameraAxes, lookAt } from '../state/orbit-pose.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import { add, scale, subtract, type Vec3 } from '../state/vec3.ts';
import { fromWalk, type WalkAxes } from './make-ground.ts';
import type { TravelMode } from './travel.ts';
import type { Walker } from './walker.ts';

/** Longest step of the walker, s: it does not jump after a pause, as when the page was hidden. */
const LONGEST_STEP_S = 1;
/** Distance of the camera's orbit target after a walk, in eye heights ahead. */
const TARGET_EYE_HEIGHTS = 2;
/**
 * A camera further than this from where the walk put it, in eye heights, was moved by something
 * else.
 */
const MOVED_EYE_HEIGHTS = 1e-3;

/** Whether the state change alters the solid parts of the scene, or which way is down. */
export function isOtherGround(state: ViewerState, before: ViewerState): boolean {
  return (
    state.scene !== before.scene ||
    state.isFlipped !== before.isFlipped ||
    state.isZUp !== before.isZUp ||
    state.inspecting.crop !== before.inspecting.crop
  );
}

/** Walks on the ground; the wheel changes the eye height, which scales all other lengths. */
export class Walk implements TravelMode {
  readonly begun;
  readonly isOver = isOtherGround;
  readonly #store: ViewerStore;
  readonly #camera: ViewCamera;
  readonly #walker: Walker;
  readonly #axes: WalkAxes;
  /** Camera position set by the last step. */
  #position: Vec3 | null = null;

  constructor(store: ViewerStore, camera: ViewCamera, walker: Walker, axes: WalkAxes) {
    this.#store = store;
    this.#camera = camera;
    this.#walker = walker;
    this.#axes = axes;
    this.begun = { by: 'walk', eyeHeight: walker.eyeHeight } as const;
  }

  move(direction: Vec3 | null, isFast: boolean, elapsedMs: number): boolean {
    const { travelling } = this.#store.getState();
    if (travelling?.by !== 'walk') return false;
    const { controls } = this.#camera;
    const { pose } = controls;
    const { eyeHeight } = travelling;
    const moved = this.#position && Math.hypot(...subtract(lookAt(pose).position, this.#position));
    if (moved && moved > MOVED_EYE_HEIGHTS * eyeHeight) {
      this.#store.setState({ travelling: null });
      return false;
    }
    const walker = this.#walker;
    walker.eyeHeight = eyeHeight;
    const [right, up, ahead] = direction ?? [0, 0, 0];
    const run = Math.hypot(right, ahead);
    // Jumping does not slow the walk.
    const part = run > 0 ? Math.min(1, Math.hypot(right, up, ahead)) / run : 0;
    const [sine, cosine] = [Math.sin(pose.azimuth), Math.cos(pose.azimuth)];
    const way = [part * (right * cosine - ahead * sine), part * (-right * sine - ahead * cosine)] as const;
    const elapsedS = Math.min(LONGEST_STEP_S, elapsedMs / 1000);
    if (walker.advance(elapsedS, { way, isFast, isJumping: up > 0 }))
      this.#store.setState({ notice: 'The ground ended here: you are back where you last stood.' });
    const position = fromWalk(this.#axes, walker.eyes);
    // Setting the camera, even to the same position, requests another frame.
    if (this.#position?.every((value, axis) => value === position[axis])) {
      return direction !== null || walker.isMoving;
    }
    const distance = Math.min(pose.distance, TARGET_EYE_HEIGHTS * eyeHeight);
    const target = add(position, scale(cameraAxes(pose).back, -distance));
    this.#position = position;
    controls.moveTo({ ...pose, target, distance });
    return direction !== null || walker.isMoving;
  }

  scale(factor: number): void {
    const eyeHeight = this.#walker.eyeHeight * factor;
    this.#store.setState({ travelling: { by: 'walk', eyeHeight } });
  }
}
