// What three calls things, as effects take them.
import type { Vec3 } from '@websplatter/core';
import type { ClipVolume, FogOptions } from '@websplatter/core/effects';
import {
  Box3,
  Color,
  type ColorRepresentation,
  type Fog,
  type FogExp2,
  type Plane,
  Sphere,
  SRGBColorSpace,
  Vector3,
} from 'three/webgpu';

/** Red, green and blue of any colour of three's, sRGB-encoded as effects take them. */
export function encodedColor(color: ColorRepresentation): Vec3 {
  const { r, g, b } = new Color(color).getRGB(new Color(), SRGBColorSpace);
  // As shaders have it: white comes back as 0.9999999999999999, which would be a tint.
  return [Math.fround(r), Math.fround(g), Math.fround(b)];
}

/**
 * A shape of three's, in world space, as a volume for `clip`. Of a plane the side that its normal points to is the inside:
 * what stays is what three's own clipping planes leave.
 *
 * @param keep which side stays.
 */
export function clipVolumeOf(
  shape: Box3 | Sphere | Plane,
  keep: 'inside' | 'outside' = 'inside',
): ClipVolume {
  if (shape instanceof Box3) {
    const center = shape.getCenter(new Vector3()).toArray();
    return { shape: 'box', center, size: shape.getSize(new Vector3()).toArray(), keep };
  }
  if (shape instanceof Sphere)
    return { shape: 'sphere', center: shape.center.toArray(), radius: shape.radius, keep };
  const point = shape.coplanarPoint(new Vector3()).toArray();
  return { shape: 'plane', point, normal: shape.normal.toArray(), keep };
}

/** Fog of a scene, as `fog` takes it. */
export function fogOptionsOf(fog: Fog | FogExp2): FogOptions {
  const color = encodedColor(fog.color);
  if ('density' in fog) return { color, density: fog.density };
  // three takes any numbers; where the end is not behind the beginning, fog stands there like a wall.
  return { color, near: fog.near, far: Math.max(fog.far, fog.near + 1e-6) };
}
