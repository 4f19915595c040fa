import type { Volume } from '@websplatter/core/effects';
import type { Object3D } from 'three/webgpu';

/** A volume as an object of a scene: a SplatVolumeObject. */
export interface SceneVolume extends Object3D {
  toVolume(): Volume;
}

/** Volumes by the object at the top of their tree. */
const volumesBelow = new WeakMap<Object3D, Set<SceneVolume>>();

/** Notes that a volume is below `root`. */
export function addVolume(root: Object3D, volume: SceneVolume): void {
  const volumes = volumesBelow.get(root) ?? new Set();
  volumesBelow.set(root, volumes.add(volume));
}

/** Returns the volumes below `root` in no order, among them some that have left it. */
export function volumesIn(root: Object3D): ReadonlySet<SceneVolume> | undefined {
  return volumesBelow.get(root);
}
