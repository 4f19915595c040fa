import { boundsOf, type Sphere } from '../camera/scene-bounds.ts';
import type { ShownScene } from '../engine/open/shown-scene.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { LengthScale, LengthUnit } from '../state/inspecting.ts';
import { cameraAxes, lookAt } from '../state/orbit-pose.ts';
import type { ViewerStore } from '../state/store.ts';
import { add, dot, scale, subtract, type Vec3, withAxis } from '../state/vec3.ts';
import { toggleFlight } from './flight.ts';
import type { Ground } from './ground.ts';
import { makeGround, REACH, toWalk, type WalkAxes } from './make-ground.ts';
import { Travel } from './travel.ts';
import { isOtherGround, Walk } from './walk.ts';
import { EYES_M, standingPlace, Walker } from './walker.ts';

const METRES: Readonly<Record<LengthUnit, number>> = {
  mm: 1e-3,
  cm: 1e-2,
  m: 1,
  km: 1e3,
  in: 0.0254,
  ft: 0.3048,
};
/** Largest eye height as a fraction of the scene's height: rooms are higher than the eyes. */
const MOST_HEIGHTS = 0.65;
/** Largest eye height as a fraction of a flat scene's width. */
const MOST_WIDTHS = 1 / 12;
/**
 * Smallest eye height as a fraction of the width, for 240 metres: in wider scenes, steps vanish in
 * the mesh's cells.
 */
const LEAST_WIDTHS = 1 / 150;

/**
 * Guesses the eye height of a person in scene units. If no known length has been set, units are
 * taken as metres, which phones and surveys write. The guess is clamped to heights that suit the
 * size of the scene: training from pictures alone knows no units.
 *
 * @param size width, height and depth of the scene.
 */
export function guessedEyeHeight([width, height, depth]: Vec3, known: LengthScale | null): number {
  if (known) return EYES_M / (known.perSceneUnit * METRES[known.unit]);
  const widest = Math.max(width, depth);
  const most = Math.max(MOST_HEIGHTS * height, MOST_WIDTHS * widest) || EYES_M;
  return Math.min(Math.max(EYES_M, LEAST_WIDTHS * widest), most);
}

const NO_GROUND = 'There is no ground to walk on near the camera, which flies instead.';
const NO_GROUND_BESIDE = 'There is no ground to walk on in front of this object: the camera flies instead.';
const LOADING = 'Walking needs the whole scene, which is still loading.';
const STREAMED = 'Walking needs all splats of a scene, and this scene streams only the splats in view.';
/** Distances ahead of the camera at which ground is searched, in eye heights. */
const AHEAD_EYE_HEIGHTS = Array.from({ length: 100 }, (_, i) => (i + 1) / 2);

interface KeptGround {
  /** Null if nothing is solid. */
  readonly ground: Ground | null;
  readonly around: Vec3;
  readonly eyeHeight: number;
}

/** Starts walks, on ground that it builds and caches. */
export class Walks {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  #kept: KeptGround | null = null;
  #making: AbortController | null = null;
  /** Guessed or set for this scene. */
  #eyeHeight: number | null = null;

  constructor(viewer: Viewer, store: ViewerStore) {
    this.#viewer = viewer;
    this.#store = store;
    store.subscribe((state, before) => {
      if (state.travelling?.by === 'walk') this.#eyeHeight = state.travelling.eyeHeight;
      const isOtherScale = state.inspecting.scale !== before.inspecting.scale;
      if (state.scene !== before.scene || isOtherScale) this.#eyeHeight = null;
      const isOther = isOtherGround(state, before);
      if (isOther) this.#kept = null;
      if (isOther || state.groundPart === null) this.#making?.abort();
    });
  }

  /** Starts a walk; ends a walk or its preparation. */
  async toggle(): Promise<void> {
    const store = this.#store;
    const { travelling, groundPart } = store.getState();
    if (groundPart !== null || travelling?.by === 'walk') {
      store.setState(groundPart === null ? { travelling: null } : { groundPart: null });
      return;
    }
    const { newest, isPartial } = this.#viewer.scenes;
    if (!newest || isPartial) store.setState({ notice: LOADING });
    else if (newest.clouds.some(({ cloud }) => cloud.stream)) store.setState({ notice: STREAMED });
    else await this.#prepare(newest);
  }

  async #prepare(scene: ShownScene): Promise<void> {
    const store = this.#store;
    const { controls, subjectSphere, groundHeight } = this.#viewer.camera;
    const { pose } = controls;
    const axes = cameraAxes({ ...pose, azimuth: 0, polar: Math.PI / 2 });
    const { position } = lookAt(pose);
    const isWithin =
      subjectSphere && Math.hypot(...subtract(position, subjectSphere.center)) < subjectSphere.radius;
    this.#eyeHeight ??= eyeHeightIn(scene, axes, subjectSphere, store.getState().inspecting.scale);
    const eyeHeight = this.#eyeHeight;
    const around = aroundWalk(toWalk(axes, isWithin ? position : pose.target), groundHeight, eyeHeight);
    if (!this.#kept || !suits(this.#kept, around, eyeHeight)) {
      const making = new AbortController();
      const { signal } = making;
      this.#making = making;
      store.setState({ groundPart: 0 });
      try {
        const { inspecting, isFlipped } = store.getState();
        const ground = await makeGround({
          clouds: scene.clouds,
          isFlipped,
          crop: inspecting.crop,
          axes,
          around,
          eyeHeight,
          signal,
          onProgress: (part) => signal.aborted || store.setState({ groundPart: part }),
        });
        signal.throwIfAborted();
        this.#kept = { ground, around, eyeHeight };
      } catch (error) {
        if (!signal.aborted) {
          const reason = error instanceof Error ? error.message : String(error);
          store.setState({ notice: `Walking is not possible. ${reason}` });
        }
        return;
      } finally {
        if (this.#making === making) {
          this.#making = null;
          store.setState({ groundPart: null });
        }
      }
    }
    this.#begin(this.#kept.ground, axes, eyeHeight);
  }

  #begin(ground: Ground | null, axes: WalkAxes, eyeHeight: number): void {
    const store = this.#store;
    const { camera, canvas } = this.#viewer;
    const place = ground && this.#place(ground, axes, eyeHeight);
    if (!place || !canvas) {
      store.setState({ notice: camera.isSubjectObject ? NO_GROUND_BESIDE : NO_GROUND });
      if (store.getState().travelling === null) toggleFlight(this.#viewer, store);
      return;
    }
    store.setState({ travelling: null });
    const { controls } = camera;
    const { feet, eyes } = place;
    const isMoved = eyes === null;
    if (isMoved) controls.moveTo({ ...controls.pose, polar: Math.PI / 2 });
    const lag = isMoved || camera.isMotionReduced ? 0 : eyes[1] - eyeHeight - feet[1];
    new Travel(
      store,
      camera,
      canvas,
      new Walk(store, camera, new Walker(ground, feet, eyeHeight, lag), axes),
    );
  }

  /**
   * Where to stand: below the camera if it is inside the scene, else below its orbit target, else
   * at the first place ahead; beside an object that the camera is not inside of. `eyes` is the
   * camera's position if the walk starts there, else null.
   */
  #place(ground: Ground, axes: WalkAxes, eyeHeight: number): { feet: Vec3; eyes: Vec3 | null } | null {
    const { controls, isSubjectObject, subjectSphere } = this.#viewer.camera;
    const { pose } = controls;
    const eyes = toWalk(axes, lookAt(pose).position);
    const isRoofed = ([x, y, z]: Vec3) => ground.above(x, y, z) !== null;
    const middle =
      isSubjectObject && subjectSphere && !isRoofed(eyes) ? toWalk(axes, subjectSphere.center) : null;
    const standing = (from: Vec3) => {
      const feet = standingPlace(ground, from, eyeHeight);
      // In an object there is something above, and on top of it the ground is high.
      const isBeside = feet && (!middle || (feet[1] < middle[1] && !isRoofed(add(feet, [0, eyeHeight, 0]))));
      return isBeside ? feet : null;
    };
    const { min, max } = ground.bounds;
    const isWithin = eyes.every((value, axis) => value >= min[axis] && value <= max[axis] + eyeHeight);
    const below = isWithin ? standing(eyes) : null;
    if (below) return { feet: below, eyes };
    const back = toWalk(axes, cameraAxes(pose).back);
    const ahead = AHEAD_EYE_HEIGHTS.map((part) => part * eyeHeight);
    const ways = middle
      ? ahead.filter((way) => way < Math.hypot(...subtract(middle, eyes)))
      : [pose.distance, ...ahead];
    for (const way of ways) {
      const feet = standing(subtract(eyes, scale(back, way)));
      if (feet) return { feet, eyes: null };
    }
    return null;
  }
}

/**
 * Whether cached ground contains the camera and is neither too coarse nor too small for a person.
 */
function suits(kept: KeptGround, around: Vec3, eyeHeight: number): boolean {
  const [x, y, z] = subtract(around, kept.around).map((way) => Math.abs(way) / kept.eyeHeight);
  const isNear = 2 * Math.max(x, z) < REACH.sideways && 2 * y < REACH.up;
  return isNear && Math.abs(Math.log2(eyeHeight / kept.eyeHeight)) < 1;
}

/** Centre of the ground for a walk that starts near `place`; not below known ground. */
function aroundWalk(place: Vec3, groundHeight: number | null, eyeHeight: number): Vec3 {
  if (groundHeight === null) return place;
  return withAxis(place, 1, Math.max(place[1], groundHeight + eyeHeight));
}

function eyeHeightIn(
  { clouds }: ShownScene,
  { right, above, back }: WalkAxes,
  sphere: Sphere | null,
  known: Parameters<typeof guessedEyeHeight>[1],
): number {
  const { min, max } = boundsOf(clouds, 'robustBounds');
  const sides = subtract(max, min);
  const along = ([x, y, z]: Vec3) => dot([Math.abs(x), Math.abs(y), Math.abs(z)], sides);
  // Bounds may include a sky; the sphere around the detail does not.
  const most = sphere && !sphere.halfSize ? 2 * sphere.radius : Number.POSITIVE_INFINITY;
  const size = [right, above, back].map((axis) => Math.min(along(axis), most));
  return guessedEyeHeight([size[0], size[1], size[2]], known);
}
