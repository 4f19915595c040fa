import type { Vec3 } from '@websplatter/core';
import type { Volume } from '@websplatter/core/effects';
import { type ColorRepresentation, Object3D } from 'three/webgpu';
import { rootOf } from '../layer/splat-layer.ts';
import { encodedColor } from './effect-options.ts';
import { addVolume } from './scene-volumes.ts';

/** Properties of a `SplatVolumeObject`, for its constructor. */
export type SplatVolumeParameters = Partial<Pick<SplatVolumeObject, (typeof PROPERTIES)[number]>>;

const PROPERTIES = [
  'shape',
  'mode',
  'softEdge',
  'invert',
  'size',
  'radius',
  'height',
  'opacity',
  'tint',
  'offset',
] as const;

/**
 * A volume as an object of a scene, which hides, keeps, fades, tints or displaces the splats in it.
 * Place, turn and scale it like any object: with controls, in animations, below other objects.
 *
 * It acts on the clouds below its nearest ancestor with clouds: on all of the scene if it is the
 * scene's child, or on a single cloud if it is the cloud's child. Volumes act in the order of the
 * scene's tree, after those of the cloud's own effect `volumes`. Invisible ones do nothing.
 *
 * Numbers out of range are clamped, because springs overshoot. Other invalid values are reported by
 * `onError` of the clouds, which are then drawn as before. A volume that is scaled to 0 contains
 * nothing.
 *
 * @example
 * const eraser = new SplatVolumeObject({ shape: 'sphere', mode: 'hide', softEdge: 0.1 });
 * eraser.scale.setScalar(0.3);
 * scene.add(eraser);
 */
export class SplatVolumeObject extends Object3D {
  override readonly type: string = 'SplatVolumeObject';
  readonly isSplatVolumeObject = true;
  /**
   * `box`, `sphere`, `ellipsoid`, `capsule` along y, or `plane`: the half-space of positive z, the
   * side that three's PlaneGeometry faces.
   */
  shape: Volume['shape'] = 'box';
  /** What happens to splats inside; `keep` hides the splats outside. */
  mode: Volume['mode'] = 'hide';
  /** Distance from the surface over which the change fades out, world units, whatever the scale. */
  softEdge = 0;
  /** Whether the volume acts outside instead of inside. */
  invert = false;
  /** Edges of a box, or diameters of an ellipsoid. */
  size: Vec3 = [1, 1, 1];
  /** Radius of a sphere or capsule. */
  radius = 1;
  /** Length of a capsule without its half-spheres. */
  height = 1;
  /** Factor of the opacity, 0…1, for `fade`. */
  opacity = 0.5;
  /** Factor of colours, for `tint`: a colour, or red, green and blue, sRGB-encoded, 0 or more. */
  tint: ColorRepresentation | Vec3 = [1, 1, 1];
  /** How far splats are moved, for `displace`; turned and scaled with the object. */
  offset: Vec3 = [0, 0, 0];

  constructor(parameters: SplatVolumeParameters = {}) {
    super();
    Object.assign(this, parameters);
  }

  override updateMatrixWorld(force?: boolean): void {
    super.updateMatrixWorld(force);
    const root = rootOf(this);
    if (root !== this) addVolume(root, this);
  }

  override copy(source: this, recursive?: boolean): this {
    super.copy(source, recursive);
    for (const name of PROPERTIES) Object.assign(this, { [name]: source[name] });
    return this;
  }

  /**
   * Returns the volume for the effect `volumes`, as of the last update of the world matrix.
   *
   * @throws InvalidArgumentError for a `tint` that is not a colour.
   */
  toVolume(): Volume {
    const { shape, mode, softEdge, invert, size, radius, height, opacity, tint, offset } = this;
    return {
      shape,
      mode,
      invert,
      offset,
      softEdge: notNegative(softEdge),
      size: Array.isArray(size) ? size.map(notNegative) : size,
      radius: notNegative(radius),
      height: notNegative(height),
      opacity: Math.min(notNegative(opacity), 1),
      tint: Array.isArray(tint) ? tint.map(notNegative) : encodedColor(tint as ColorRepresentation),
      // Copied: the next frame is compared with this one.
      matrix: [...this.matrixWorld.elements],
    } as unknown as Volume;
  }
}

/** Returns NaN as it is, which the effect refuses. */
function notNegative(value: number): number {
  return value < 0 ? 0 : value;
}
