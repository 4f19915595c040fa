import { type OrthographicCamera, type Quaternion, Vector3 } from 'three';
import type { FittedCamera } from './fit-camera.ts';

/** OrbitControls, MapControls, TrackballControls, ArcballControls: they read the camera's place. */
interface TargetControls {
  readonly target: Vector3;
  update?(): void;
  /** Rotation from `camera.up` to y, fixed when OrbitControls or MapControls were made. */
  readonly _quat?: Quaternion;
  readonly _quatInverse?: Quaternion;
}

/** `camera-controls` (drei's `<CameraControls>`): they overwrite the camera's position. */
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
 * Makes `controls` orbit `camera` about `target`, from its present position and about its `up`. The
 * camera must look at `target`. Controls without a target, such as FlyControls, are left unchanged:
 * their `update` requires the time since the last frame.
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
    // A focal offset would move the camera away from its position.
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
