import { invert3, linearPart, multiply4, transform3, type Vec3 } from '../../../data/math/mat4.ts';
import { rotationMatrix } from '../../../reference/covariance.ts';
import { edgeFade } from '../../../reference/effects/edge-fade.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import { worldPosition } from '../../../reference/effects/world-position.ts';
import type { EffectPlace } from '../effect.ts';
import type { Volume } from './volumes.ts';

export const example: readonly Volume[] = [
  {
    shape: 'box',
    mode: 'keep',
    center: [0.1, 0, 0.1],
    size: [2, 1.5, 2],
    rotation: [0.1, 0.4, -0.2, 0.9],
    softEdge: 0.1,
  },
  { shape: 'sphere', mode: 'hide', center: [0.4, 0.2, 0.5], radius: 0.3, softEdge: 0.1 },
  { shape: 'plane', mode: 'fade', opacity: 0.4, point: [-0.3, 0, 0], normal: [-2, 0.4, 0], softEdge: 0.2 },
  { shape: 'capsule', mode: 'displace', offset: [0, 0.3, 0.1], radius: 0.3, height: 0.5, softEdge: 0.2 },
  { shape: 'ellipsoid', mode: 'tint', tint: [1.5, 0.6, 0.2], size: [1, 1.5, 0.8], softEdge: 0.3 },
];

export function reference(volumes: readonly Volume[], place: EffectPlace): EffectReference {
  const toCloud = invert3(linearPart(place.modelMatrix));
  const weigh = (volume: Volume, position: Vec3) => weightAt(volume, worldPosition(position, place));
  const changing = volumes.filter(({ mode }) => mode !== 'tint');
  const tinting = volumes.filter(({ mode }) => mode === 'tint');
  return {
    ...(changing.length > 0 && {
      changeSplat: (splat) => {
        let { position, opacity } = splat;
        for (const volume of changing) {
          const weight = weigh(volume, position);
          if (volume.mode === 'displace') {
            const { offset, matrix = IDENTITY } = volume;
            const moved = toCloud ? transform3(toCloud, transform3(linearPart(matrix), offset)) : [0, 0, 0];
            position = position.map((value, axis) => value + weight * moved[axis]) as unknown as Vec3;
          } else opacity *= 1 - weight * (1 - (volume.mode === 'fade' ? volume.opacity : 0));
        }
        return { ...splat, position, opacity };
      },
    }),
    ...(tinting.length > 0 && {
      changeColor: (color, splat) => {
        let tinted = color;
        for (const volume of tinting) {
          if (volume.mode !== 'tint') continue;
          const weight = weigh(volume, splat.position);
          const factors = volume.tint.map((factor) => 1 - weight * (1 - factor));
          tinted = [tinted[0] * factors[0], tinted[1] * factors[1], tinted[2] * factors[2]];
        }
        return tinted;
      },
    }),
  };
}

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** How much a volume acts on a point of the world, 0…1. */
function weightAt(volume: Volume, position: Vec3): number {
  const { softEdge = 0, invert = false, mode } = volume;
  const outside = distanceFrom(volume, position);
  const isInverted = mode === 'keep' ? !invert : invert;
  return 1 - edgeFade(isInverted ? -outside : outside, softEdge);
}

/** Distance of a point of the world from a volume's surface, negative inside. */
function distanceFrom(volume: Volume, position: Vec3): number {
  const matrix = multiply4(volume.matrix ?? IDENTITY, ownMatrix(volume));
  const inverse = invert3(linearPart(matrix));
  const half = halfSizes(volume);
  if (!inverse || half.includes(0)) return Number.POSITIVE_INFINITY;
  // In the volume's own space, about its centre.
  const offset = position.map((value, axis) => value - matrix[12 + axis]);
  const own = transform3(inverse, offset);
  // Distances in the world between planes x, y or z = 0 and 1 of that space.
  const units = [0, 1, 2].map((row) => 1 / Math.hypot(inverse[row], inverse[3 + row], inverse[6 + row]));
  if (volume.shape === 'plane') {
    const { normal = [0, 0, 1] } = volume;
    const slope = [0, 1, 2].map(
      (c) => normal[0] * inverse[3 * c] + normal[1] * inverse[3 * c + 1] + normal[2] * inverse[3 * c + 2],
    );
    return -(own[0] * normal[0] + own[1] * normal[1] + own[2] * normal[2]) / Math.hypot(...slope);
  }
  if (volume.shape === 'box') {
    const beyond = own.map((value, axis) => (Math.abs(value) - half[axis]) * units[axis]);
    const outside = Math.hypot(...beyond.map((distance) => Math.max(0, distance)));
    return outside > 0 ? outside : Math.max(...beyond);
  }
  const middle = volume.shape === 'capsule' ? (volume.height ?? 1) / 2 : 0;
  const fromMiddle = [own[0], own[1] - Math.min(Math.max(own[1], -middle), middle), own[2]];
  const inRadii = fromMiddle.map((value, axis) => value / half[axis]);
  const radii = Math.hypot(...inRadii);
  if (radii === 0) return -Math.min(...half.map((length, axis) => length * units[axis]));
  // The gradient of `radii`, along axes that are taken as orthogonal.
  const slope = Math.hypot(...inRadii.map((value, axis) => value / radii / (half[axis] * units[axis])));
  return (radii - 1) / slope;
}

/** From a shape about the origin, without a rotation, to the volume's own space. */
function ownMatrix(volume: Volume): number[] {
  if (volume.shape === 'plane')
    return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...(volume.point ?? [0, 0, 0]), 1];
  const [x, y, z, w] = ('rotation' in volume && volume.rotation) || [0, 0, 0, 1];
  const r = rotationMatrix(w, x, y, z);
  // `rotationMatrix` is row-major.
  return [r[0], r[3], r[6], 0, r[1], r[4], r[7], 0, r[2], r[5], r[8], 0, ...(volume.center ?? [0, 0, 0]), 1];
}

function halfSizes(volume: Volume): readonly number[] {
  switch (volume.shape) {
    case 'plane':
      return [1, 1, 1];
    case 'box':
    case 'ellipsoid':
      return (volume.size ?? [1, 1, 1]).map((length) => length / 2);
    default:
      return Array(3).fill(volume.radius ?? 1);
  }
}
