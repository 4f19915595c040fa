import { flown } from '../camera/fly-pose.ts';
import type { ViewCamera } from '../camera/view-camera.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { ViewerStore } from '../state/store.ts';
import { clamp, scale, type Vec3 } from '../state/vec3.ts';
import { Travel, type TravelMode } from './travel.ts';

/** Speed 1 covers this many scene radii per second. */
const RADII_PER_S = 0.4;
/** Shift multiplies the speed by this. */
const FAST_FACTOR = 4;
const SPEED_RANGE = { min: 0.02, max: 50 } as const;

/** Flies through the scene in the direction of the keys; the wheel changes the speed. */
export class Flight implements TravelMode {
  readonly begun = { by: 'fly', speed: 1 } as const;
  readonly #store: ViewerStore;
  readonly #camera: ViewCamera;

  constructor(store: ViewerStore, camera: ViewCamera) {
    this.#store = store;
    this.#camera = camera;
  }

  move(direction: Vec3 | null, isFast: boolean, elapsedMs: number): boolean {
    if (!direction) return false;
    const { controls, subjectRadius } = this.#camera;
    const speed = this.#speed * (isFast ? FAST_FACTOR : 1);
    const way = (speed * RADII_PER_S * subjectRadius * elapsedMs) / 1000;
    controls.moveTo(flown(controls.pose, scale(direction, way)));
    return true;
  }

  scale(factor: number): void {
    const speed = clamp(this.#speed * factor, SPEED_RANGE.min, SPEED_RANGE.max);
    this.#store.setState({ travelling: { by: 'fly', speed } });
  }

  get #speed(): number {
    const { travelling } = this.#store.getState();
    return travelling?.by === 'fly' ? travelling.speed : 0;
  }
}

/** Starts a flight through the scene, or ends it. */
export function toggleFlight({ camera, canvas, scenes }: Viewer, store: ViewerStore): void {
  const { travelling } = store.getState();
  store.setState({ travelling: null });
  if (travelling?.by !== 'fly' && canvas && scenes.newest)
    new Travel(store, camera, canvas, new Flight(store, camera));
}
