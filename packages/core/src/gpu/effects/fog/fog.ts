import { given, wrongArgument } from '../../../data/given.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { effectFunction } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import { checkVector, isFiniteF32 } from '../option-checks.ts';
import wgsl from './fog.wgsl?raw';

interface FogColor {
  /** sRGB-encoded red, green and blue, 0 or more. */
  readonly color: Vec3;
}

/** Like three's `Fog`. */
export interface FogBetween extends FogColor {
  /** View depth up to which there is no fog, world units. */
  readonly near: number;
  /** View depth from which on fog hides everything, world units. */
  readonly far: number;
}

/** Like three's `FogExp2`. */
export interface FogOfDensity extends FogColor {
  /**
   * Density per world unit, 0 or more: at view depth d, e^−(density·d)² of a splat's light is left.
   */
  readonly density: number;
}

/** Options of `fog`. */
export type FogOptions = FogBetween | FogOfDensity;

/**
 * Mixes the colour of splats with the fog's colour by the view depth of their centres, in
 * perspective and orthographic views alike. It mixes in linear light, so that splats and meshes in
 * the same fog look the same. Opacities do not change.
 *
 * @example
 * const clouds = [{ cloud, effects: [fog({ color: [0.8, 0.85, 0.9], near: 5, far: 60 })] }];
 */
export const fog = /* @__PURE__ */ effectFunction<
  FogOptions,
  { color: 'vec3f'; near: 'f32'; range: 'f32'; density: 'f32' }
>({
  ...EFFECT_LIST.fog,
  wgsl,
  fields: { color: 'vec3f', near: 'f32', range: 'f32', density: 'f32' },
  check(options) {
    given(options, {}, 'fog');
    checkVector('color', options.color, 'the sRGB-encoded colour of fog', { isNonNegative: true });
    if ('density' in options) {
      const { density } = options;
      if ('near' in options || 'far' in options)
        throw wrongArgument('density', density, 'given instead of near and far, not with them');
      if (!(isFiniteF32(density) && density >= 0))
        throw wrongArgument('density', density, 'the density of fog: a finite number, 0 or more');
      return;
    }
    const { near, far } = options;
    if (!isFiniteF32(near))
      throw wrongArgument('near', near, 'the view depth where fog begins: a finite number');
    if (!(isFiniteF32(far) && far > near))
      throw wrongArgument(
        'far',
        far,
        `the view depth where fog is complete: a finite number above near, ${near}`,
      );
  },
  calledFor(options) {
    if ('density' in options)
      return options.density === 0 ? null : `there is fog of density ${options.density}`;
    return `there is fog between depths of ${options.near} and ${options.far}`;
  },
  valuesAt: (options) =>
    'density' in options
      ? { color: options.color, near: 0, range: 0, density: options.density }
      : { color: options.color, near: options.near, range: options.far - options.near, density: 0 },
});
