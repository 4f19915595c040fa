import { transform3, type Vec3 } from '../../../data/math/mat4.ts';
import { rotationMatrix } from '../../../reference/covariance.ts';
import { edgeFade } from '../../../reference/effects/edge-fade.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import { worldPosition } from '../../../reference/effects/world-position.ts';
import type { EffectPlace } from '../effect.ts';
import type { ClipBox, ClipOptions, ClipVolume } from './clip.ts';

export const example: ClipOptions = {
  volumes: [
    { shape: 'box', center: [0.1, 0, 0.1], size: [2, 1.5, 2], rotation: [0.1, 0.4, -0.2, 0.9] },
    { shape: 'sphere', center: [0.4, 0.2, 0.5], radius: 0.3, keep: 'outside' },
    { shape: 'plane', point: [-0.5, 0, 0], normal: [2, 0.4, 0] },
  ],
  softEdge: 0.1,
};

export function reference({ volumes, softEdge = 0 }: ClipOptions, place: EffectPlace): EffectReference {
  return {
    changeSplat(splat) {
      const position = worldPosition(splat.position, place);
      const clearances = volumes.map((volume) => {
        const depth = depthInside(volume, position);
        return volume.keep === 'outside' ? -depth : depth;
      });
      return { ...splat, opacity: splat.opacity * edgeFade(Math.min(...clearances), softEdge) };
    },
  };
}

/** Distance of a point of the world from a volume's surface, positive inside. */
function depthInside(volume: ClipVolume, position: Vec3): number {
  switch (volume.shape) {
    case 'box':
      return depthInBox(volume, position);
    case 'sphere':
      return volume.radius - Math.hypot(...difference(position, volume.center));
    case 'plane': {
      const { normal, point } = volume;
      const offset = difference(position, point);
      const along = normal[0] * offset[0] + normal[1] * offset[1] + normal[2] * offset[2];
      return along / Math.hypot(...normal);
    }
  }
}

function depthInBox({ center, size, rotation = [0, 0, 0, 1] }: ClipBox, position: Vec3): number {
  const [x, y, z, w] = rotation;
  // The row-major matrix is read as column-major: its transpose, the inverse rotation.
  const back = rotationMatrix(w, x, y, z);
  const beyond = transform3(back, difference(position, center)).map(
    (offset, axis) => Math.abs(offset) - size[axis] / 2,
  );
  const outside = Math.hypot(...beyond.map((distance) => Math.max(0, distance)));
  return outside > 0 ? -outside : -Math.max(...beyond);
}

function difference(a: Vec3, b: Vec3): Vec3 {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}
