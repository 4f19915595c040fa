import type { SceneFraming } from '@websplatter/core';
import { type FrameSplatsOptions, placeCamera } from '@websplatter/three';
import { Box3, type Object3D, type OrthographicCamera, Quaternion, Vector3 } from 'three';
import type { LeftView } from './canvas-states.ts';
import { type FittedCamera, fitCamera } from './fit-camera.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';

/** The parts of a Canvas that a fitter uses. */
export interface FittedCanvas {
  /** Parent of the clouds; null while it is not mounted. */
  group(): Object3D | null;
  camera(): FittedCamera;
  /** The Canvas's controls (`makeDefault`), of any kind; null if there are none. */
  controls(): object | null;
  /** Finds where a photographer would place the camera; null if nothing can be seen. */
  frame(group: Object3D, camera: FittedCamera, options: FrameSplatsOptions): Promise<SceneFraming | null>;
  invalidate(): void;
}

interface Pose {
  readonly camera: FittedCamera;
  readonly position: Vector3;
  readonly turn: Quaternion;
}

/** Framing of the present clouds, and centre and size of their detail in the group's space. */
interface Found {
  readonly framing: SceneFraming;
  readonly center: Vector3;
  readonly scale: number;
}

/** Default camera positions of react-three-fiber and of drei. */
const DEFAULT_PLACES = [new Vector3(0, 0, 5), new Vector3(0, 0, 0)];
const DEFAULT_UP = new Vector3(0, 1, 0);
const NO_TURN = new Quaternion();
/**
 * Least change that counts as a move: radians, and parts of the distance to 0. Controls compute the
 * camera's pose anew in every frame, with rounding.
 */
const ROUNDING = 1e-4;

/** Fits a camera to the clouds in a group: to their bounds at once, then by `frameSplats`. */
export class BoundsFitter {
  readonly #canvas: FittedCanvas;
  #found: Found | null = null;
  /** Last pose set by this fitter; null if it set none, or the application set the camera. */
  #placed: Pose | null = null;
  /** The camera after the last fit, whoever had set it before; null before the first. */
  #fitted: Pose | null = null;
  /** `camera.up` as set by this fitter, or three's default. */
  #foundUp = DEFAULT_UP;
  #work: AbortController | null = null;
  /** The controls that `bringBack` has aimed. */
  #broughtBack: object | null = null;

  constructor(canvas: FittedCanvas) {
    this.#canvas = canvas;
  }

  /** Bounds of the clouds in world space, without their outermost splats. */
  box(): Box3 {
    return this.#union(({ robustBounds }) => robustBounds);
  }

  /** Framing of the present clouds; null before it is found. */
  get framing(): SceneFraming | null {
    return this.#found?.framing ?? null;
  }

  /** Whether a framing is being found. */
  get isFraming(): boolean {
    return this.#work !== null;
  }

  /** Whether somebody has moved the camera since the last fit. Auto-rotation of controls does not count. */
  get hasMoved(): boolean {
    const { camera, controls } = this.#state();
    return this.#fitted !== null && !isRotating(controls) && !isAt(this.#fitted, camera);
  }

  /** Call when the clouds have changed: drops the framing. */
  forget(): void {
    this.end();
    this.#found = null;
  }

  /** Cancels the search for a framing. */
  end(): void {
    this.#work?.abort();
    this.#work = null;
  }

  /** See `SplatBoundsApi.fit`. */
  fit(margin: number): boolean {
    const box = this.box();
    if (box.isEmpty()) return false;
    const { camera, controls } = this.#state();
    const shown = this.#detailOf(box);
    fitCamera(
      camera,
      shown,
      margin,
      this.#union(({ bounds }) => bounds),
    );
    aimControls(controls, camera, shown.getCenter(new Vector3()));
    this.#fitted = poseOf(camera);
    this.#canvas.invalidate();
    return true;
  }

  /**
   * Aims the present controls, once, where others were aimed from the same place: those of a Canvas
   * that was lost. They begin with a target of their own.
   */
  bringBack({ position, controls: lost }: LeftView): void {
    const { camera, controls } = this.#state();
    const target = lost && targetOf(lost);
    if (!controls || !target || controls === this.#broughtBack) return;
    this.#broughtBack = controls;
    camera.position.copy(position);
    aimControls(controls, camera, target);
    this.#canvas.invalidate();
  }

  /** See `SplatBoundsApi.frame`. */
  async frame(): Promise<SceneFraming | null> {
    const framing = await this.#find();
    if (framing) this.#place(framing);
    return framing;
  }

  /**
   * Fits the camera to the bounds at once, and places it by the framing when that is found. A camera
   * that the application has placed keeps its direction. A camera that was moved meanwhile stays.
   *
   * @returns whether a cloud has been loaded, and a promise of whether its scene was framed: it never
   *   rejects.
   */
  fitLoaded(margin: number): { readonly isFitted: boolean; readonly framed: Promise<boolean> } {
    const isOurs = this.#isOurs();
    const isFitted = this.fit(margin);
    // Recorded before the framing is found: further clouds may be loaded until then.
    if (isOurs) this.#placed = poseOf(this.#canvas.camera());
    return { isFitted, framed: isFitted ? this.#frameLater(margin, isOurs) : Promise.resolve(false) };
  }

  async #frameLater(margin: number, isOurs: boolean): Promise<boolean> {
    const before = poseOf(this.#canvas.camera());
    const watch = new ControlsWatch(this.#canvas.controls());
    try {
      const framing = await this.#find();
      if (!framing) return false;
      // Auto-rotation of the controls does not count as a move.
      const hasMoved = watch.hasBegun || !(watch.isRotating || isAt(before, this.#canvas.camera()));
      if (hasMoved) return true;
      if (isOurs) this.#place(framing);
      else this.fit(margin);
      return true;
    } catch (error) {
      // Cancelled; the device was lost, which its renderer reports; a preview has been replaced; or the
      // null renderer of a test has none.
      const expected = ['AbortError', 'DestroyedError', 'SplatSourceError', 'WebGpuUnavailableError'];
      const isExpected = expected.includes((error as Error).name);
      if (!isExpected) console.warn(error);
      return false;
    } finally {
      watch.end();
    }
  }

  async #find(): Promise<SceneFraming | null> {
    this.end();
    const work = new AbortController();
    this.#work = work;
    const { signal } = work;
    const group = this.#canvas.group();
    if (!group) return null;
    const { camera } = this.#state();
    const up = camera.up.equals(DEFAULT_UP) || camera.up.equals(this.#foundUp) ? undefined : camera.up;
    const framing = await this.#canvas.frame(group, camera, { up, signal }).finally(() => {
      if (this.#work === work) this.#work = null;
    });
    signal.throwIfAborted();
    if (framing) {
      group.updateWorldMatrix(true, false);
      const center = group.worldToLocal(new Vector3(...framing.center));
      this.#found = { framing, center, scale: group.matrixWorld.getMaxScaleOnAxis() };
    }
    return framing;
  }

  #place(framing: SceneFraming): void {
    const { camera, controls } = this.#state();
    placeCamera(camera, framing);
    aimControls(controls, camera, new Vector3(...framing.target));
    this.#placed = this.#fitted = poseOf(camera);
    this.#foundUp = camera.up.clone();
    this.#canvas.invalidate();
  }

  /** Returns the part of `box` with most of the detail, if the scene has surroundings; else `box`. */
  #detailOf(box: Box3): Box3 {
    const group = this.#canvas.group();
    if (!group || !this.#found || this.#found.framing.kind === 'object') return box;
    const { framing, center, scale } = this.#found;
    group.updateWorldMatrix(true, false);
    const radius = framing.radius * (group.matrixWorld.getMaxScaleOnAxis() / scale);
    const middle = group.localToWorld(center.clone());
    const detail = new Box3()
      .setFromCenterAndSize(middle, new Vector3().setScalar(2 * radius))
      .intersect(box);
    return detail.isEmpty() ? box : detail;
  }

  /** Whether the camera has a default pose, or the last pose set by this fitter. */
  #isOurs(): boolean {
    const camera = this.#canvas.camera();
    if (this.#placed && isAt(this.#placed, camera)) return true;
    return DEFAULT_PLACES.some((position) => isAt({ camera, position, turn: NO_TURN }, camera));
  }

  #state(): { readonly camera: FittedCamera; readonly controls: object | null } {
    return { camera: this.#canvas.camera(), controls: this.#canvas.controls() };
  }

  #union(boundsOf: (data: NonNullable<SplatCloudObject['data']>) => Box3): Box3 {
    const bounds = new Box3();
    for (const cloud of cloudsIn(this.#canvas.group())) {
      cloud.updateWorldMatrix(true, false);
      if (cloud.data) bounds.union(boundsOf(cloud.data).clone().applyMatrix4(cloud.matrixWorld));
    }
    return bounds;
  }
}

/** The clouds below an object. */
export function cloudsIn(group: Object3D | null): SplatCloudObject[] {
  const clouds: SplatCloudObject[] = [];
  group?.traverse((object) => {
    if (object instanceof SplatCloudObject) clouds.push(object);
  });
  return clouds;
}

function poseOf(camera: FittedCamera): Pose {
  return { camera, position: camera.position.clone(), turn: camera.quaternion.clone() };
}

function isAt({ camera, position, turn }: Pose, now: FittedCamera): boolean {
  const isNear = position.distanceTo(now.position) <= ROUNDING * Math.max(position.length(), ROUNDING);
  return camera === now && isNear && turn.angleTo(now.quaternion) < ROUNDING;
}

/** Whether controls turn the camera by themselves. */
function isRotating(controls: object | null): boolean {
  return (controls as Partial<EventSource> | null)?.autoRotate === true;
}

/** Detects whether a user has begun to move the camera by its controls. */
class ControlsWatch {
  hasBegun = false;
  readonly #controls: Partial<EventSource>;
  readonly #begin = () => {
    this.hasBegun = true;
  };

  constructor(controls: object | null) {
    this.#controls = (controls ?? {}) as Partial<EventSource>;
    for (const type of BEGINNINGS) this.#controls.addEventListener?.(type, this.#begin);
  }

  get isRotating(): boolean {
    return isRotating(this.#controls);
  }

  end(): void {
    for (const type of BEGINNINGS) this.#controls.removeEventListener?.(type, this.#begin);
  }
}

/** Events of three's controls, and of `camera-controls`. */
const BEGINNINGS = ['start', 'controlstart'] as const;

interface EventSource {
  addEventListener(type: string, listener: () => void): void;
  removeEventListener(type: string, listener: () => void): void;
  readonly autoRotate?: boolean;
}

/** OrbitControls, MapControls, TrackballControls, ArcballControls: they read the camera's place. */
interface TargetControls {
  readonly target: Vector3;
  update?(): void;
  /** Of three's OrbitControls and MapControls: turns `camera.up` to y, as it was when they were made. */
  readonly _quat?: Quaternion;
  readonly _quatInverse?: Quaternion;
}

/** `camera-controls`, which drei has as `<CameraControls>`: they overwrite the camera's place. */
interface OwningControls {
  /** To be called when `camera.up` has changed. */
  updateCameraUp?(): void;
  setLookAt(
    positionX: number,
    positionY: number,
    positionZ: number,
    targetX: number,
    targetY: number,
    targetZ: number,
    enableTransition: boolean,
  ): unknown;
  getTarget?(out: Vector3): Vector3;
  setFocalOffset?(x: number, y: number, z: number, enableTransition: boolean): unknown;
  zoomTo?(zoom: number, enableTransition: boolean): unknown;
}

/** The point in world space that controls turn the camera about; null if they have none. */
function targetOf(controls: Partial<TargetControls & OwningControls>): Vector3 | null {
  if (controls.getTarget) return controls.getTarget(new Vector3());
  return controls.target?.isVector3 ? controls.target : null;
}

const UP_OF_CONTROLS = new Vector3(0, 1, 0);

/**
 * Makes `controls` turn `camera`, which looks at `target` now, about this point, from where it is,
 * and about its `up` if they keep one axis upright.
 * Controls without a point to turn about, such as FlyControls, are left alone: the `update` that
 * they have needs the time since the last frame.
 *
 * @param controls the Canvas's (`makeDefault`), of any kind.
 * @param target world space.
 */
export function aimControls(controls: object | null, camera: FittedCamera, target: Vector3): void {
  const { setLookAt } = (controls ?? {}) as Partial<OwningControls>;
  if (setLookAt) {
    const owning = controls as OwningControls;
    const { x, y, z } = camera.position;
    owning.updateCameraUp?.();
    owning.setLookAt(x, y, z, target.x, target.y, target.z, false);
    // It would move the camera away from its place.
    owning.setFocalOffset?.(0, 0, 0, false);
    // The zoom of a perspective camera is not fitted, and may be in a transition.
    if ((camera as OrthographicCamera).isOrthographicCamera) owning.zoomTo?.(camera.zoom, false);
    return;
  }
  const turning = controls as TargetControls | null;
  if (!turning?.target?.isVector3) return;
  turning.target.copy(target);
  turning._quat?.setFromUnitVectors(camera.up.clone().normalize(), UP_OF_CONTROLS);
  if (turning._quat) turning._quatInverse?.copy(turning._quat).invert();
  turning.update?.();
}
