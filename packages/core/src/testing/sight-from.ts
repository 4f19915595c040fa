import type { CloudSight } from '../clouds/stream/cloud-sight.ts';
import { perspectiveCamera, projectionOf } from '../data/camera/camera.ts';
import { cloudView } from '../data/camera/cloud-view.ts';
import { frustumSides } from '../data/camera/frustum.ts';
import { identity4, type Vec3 } from '../data/math/mat4.ts';

/** Before which a camera draws nothing. */
const NEAR = 0.1;

/** The sight of a camera that allows errors of this many radians. */
export function sightFrom(position: Vec3, target: Vec3, radians = 0.01): CloudSight {
  const camera = perspectiveCamera({ position, target, up: [0, 1, 0], fovYDegrees: 50, aspect: 1.6 });
  const view = cloudView(camera.viewMatrix, identity4(), [0, 0, 0], false);
  return {
    cut: {
      camera: position as [number, number, number],
      squaredPerDistance: radians ** 2,
      leastSquared: (NEAR * radians) ** 2,
      margin: 0,
    },
    squaredShift: 1,
    sides: frustumSides(view, projectionOf(camera, 160, 100), 1 / 255, 0.3),
  };
}
