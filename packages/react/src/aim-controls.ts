import type { OrthographicCamera, Vector3 } from 'three';
import type { FittedCamera } from './fit-camera.ts';

/** OrbitControls, MapControls, TrackballControls, ArcballControls: they read the camera's place. */
interface TargetControls {
  readonly target: Vector3;
  update?(): void;
}

/** `camera-controls`, which drei has as `<CameraControls>`: they overwrite the camera's place. */
interface OwningControls {
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

/**
 * Makes `controls` turn `camera`, which looks at `target` now, about this point, from where it is.
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
  turning.update?.();
}
