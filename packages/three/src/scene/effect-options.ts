// Converts three's colours and shapes into the options of effects.
import { InvalidArgumentError, type Vec3 } from '@websplatter/core';
import type { Volume } from '@websplatter/core/effects';
import {
  Box3,
  Color,
  type ColorRepresentation,
  type Plane,
  Sphere,
  SRGBColorSpace,
  Vector3,
} from 'three/webgpu';

/**
 * Returns red, green and blue of any of three's colours, sRGB-encoded as effects take them.
 *
 * @throws InvalidArgumentError for a value that is not a colour; unknown names are white.
 * @example
 * cloud.effects = [tint(encodedColor('#ffe0c0'))];
 */
export function encodedColor(color: ColorRepresentation): Vec3 {
  const isColor = typeof color === 'string' || Number.isFinite(color) || (color as Color | null)?.isColor;
  if (!isColor)
    throw new InvalidArgumentError('color', `A colour is a name, a number or a Color, no ${typeof color}.`);
  const { r, g, b } = new Color(color).getRGB(new Color(), SRGBColorSpace);
  // float32, as in shaders: three's white of 0.9999999999999999 would count as a tint.
  return [Math.fround(r), Math.fround(g), Math.fround(b)];
}

/**
 * Converts one of three's shapes, in world space, into one for `volumes`. The inside of a
 * plane is the side that its normal points to, which is the side that three's own clipping planes
 * keep.
 *
 * @param mode whether the inside stays, or everything else.
 * @example
 * const box = new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1));
 * cloud.effects = [volumes([volumeOf(box, 'hide')])];
 */
export function volumeOf(shape: Box3 | Sphere | Plane, mode: 'keep' | 'hide' = 'keep'): Volume {
  if (shape instanceof Box3) {
    const center = shape.getCenter(new Vector3()).toArray();
    return { shape: 'box', mode, center, size: shape.getSize(new Vector3()).toArray() };
  }
  if (shape instanceof Sphere)
    return { shape: 'sphere', mode, center: shape.center.toArray(), radius: shape.radius };
  const point = shape.coplanarPoint(new Vector3()).toArray();
  return { shape: 'plane', mode, point, normal: shape.normal.toArray() };
}
