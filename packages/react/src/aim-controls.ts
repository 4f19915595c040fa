import { type OrthographicCamera, type Quaternion, Vector3 } from 'three';
import type { FittedCamera } from './fit-camera.ts';

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
  setFocalOffset?(x: number, y: number, z: number, enableTransition: boolean): unknown;
  zoomTo?(zoom: number, enableTransition: boolean): unknown;
}

const UP_OF_CONTROLS = new Vector3(0, 1, 0);

/**
 * Makes `controls` turn `camera`, which looks at `target` now, about this point, from where it is,
 * and about its `up`, where they keep one axis upright.
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
