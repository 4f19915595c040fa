import { given, wrongArgument } from '../../../data/given.ts';
import { linearPart, multiply4, translated4, type Vec3 } from '../../../data/math/mat4.ts';
import { effectFunction } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import { checkLength, checkVector } from '../option-checks.ts';
import wgsl from './reveal.wgsl?raw';

/** Options of `reveal`. */
export interface RevealOptions {
  /** Where the cloud appears from: a point in world space, or the camera's position. */
  readonly from: Vec3 | 'camera';
  /**
   * Hides splats farther away than this; world units, 0 or more. 0 hides everything; Infinity shows
   * everything and turns the effect off, which ends an animation.
   */
  readonly radius: number;
  /** Width of the band inside the radius where splats fade in, world units; default 0, hard. */
  readonly softEdge?: number;
  /** Whether splats in the band also grow from nothing to their size; default true. */
  readonly grow?: boolean;
}

/**
 * Lets a cloud appear outward from a point, up to the caller's `radius`.
 *
 * @example
 * // In each frame, until all is shown.
 * const effects = [reveal({ from: 'camera', radius: performance.now() / 500, softEdge: 1 })];
 */
export const reveal = /* @__PURE__ */ effectFunction<
  RevealOptions,
  { linear: 'mat3x3f'; offset: 'vec3f'; radius: 'f32'; softEdge: 'f32'; grows: 'u32' }
>({
  ...EFFECT_LIST.reveal,
  wgsl,
  fields: { linear: 'mat3x3f', offset: 'vec3f', radius: 'f32', softEdge: 'f32', grows: 'u32' },
  check(options) {
    given(options, {}, 'reveal');
    const { from, radius, softEdge = 0 } = options;
    const place = 'where the cloud appears from, "camera" or a point in world space';
    if (typeof from === 'string') {
      if (from !== 'camera') throw wrongArgument('from', from, `${place}: 3 finite numbers`);
    } else checkVector('from', from, place);
    if (radius !== Number.POSITIVE_INFINITY)
      checkLength('radius', radius, 'how far the cloud is shown, Infinity for all of it');
    checkLength('softEdge', softEdge, 'the width of the band in which splats fade in');
  },
  calledFor: ({ from, radius }) =>
    radius === Number.POSITIVE_INFINITY
      ? null
      : `only what is within ${radius} of ${from === 'camera' ? 'the camera' : from.join(', ')} is there`,
  valuesAt({ from, radius, softEdge = 0, grow = true }, { modelMatrix, origin, viewMatrix }) {
    // Distances from the camera are distances from view space's origin, because the view matrix is
    // rigid. Both matrices are in float64, and about the cloud's origin, like the shader's
    // positions.
    const toPlace = translated4(from === 'camera' ? multiply4(viewMatrix, modelMatrix) : modelMatrix, origin);
    const start = from === 'camera' ? [0, 0, 0] : from;
    return {
      linear: Array.from(linearPart(toPlace)),
      offset: start.map((coordinate, axis) => toPlace[12 + axis] - coordinate),
      radius,
      softEdge,
      grows: grow ? 1 : 0,
    };
  },
});
