import { given, wrongArgument } from '../../../data/given.ts';
import { effectFunction } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import { checkLength, isFiniteF32 } from '../option-checks.ts';
import wgsl from './depth-of-field.wgsl?raw';

/** Options of `depthOfField`. */
export interface DepthOfFieldOptions {
  /**
   * Radius of the lens's opening, world units, 0 or more; 0 turns the effect off. A lens of focal
   * length F at f-number N has F / (2 N): in a scene in metres, 50 mm at f/2 are 0.0125.
   */
  readonly aperture: number;
  /** View depth of the plane in focus, world units, above 0. */
  readonly focusDistance: number;
}

/**
 * Blurs splats by the depth of field of a thin lens: a splat at the view depth z is spread over a
 * circle of the radius aperture · |1/focusDistance − 1/z|, in units of the tangent of the angle of
 * view, and becomes as much fainter. With an orthographic camera the radius is
 * aperture · |z/focusDistance − 1| world units.
 *
 * The blur is per splat, so it is approximate: splats are sorted by their centres and hide each
 * other as sharp ones do, and a surface that is one splat thick lets some of the background through
 * where it is blurred. Meshes stay sharp, and depths and picks are those of the blurred splats.
 *
 * @throws InvalidArgumentError unless the aperture is a finite number of 0 or more, and the distance
 *   one above 0.
 * @example
 * const effects = [depthOfField({ aperture: 0.02, focusDistance: 1.5 })];
 * view.render({ camera, clouds: [{ cloud, effects }], widthPx, heightPx });
 */
export const depthOfField = /* @__PURE__ */ effectFunction<
  DepthOfFieldOptions,
  { aperturePx: 'vec2f'; focusDistance: 'f32'; isPerspective: 'u32' }
>({
  ...EFFECT_LIST.depthOfField,
  wgsl,
  fields: { aperturePx: 'vec2f', focusDistance: 'f32', isPerspective: 'u32' },
  check(options) {
    const { aperture, focusDistance } = given(options, {}, 'depthOfField');
    checkLength('aperture', aperture, 'the radius of the lens’s opening');
    if (!(isFiniteF32(focusDistance) && focusDistance > 0)) {
      const meaning = 'the view depth that is in focus: a finite number of world units, above 0';
      throw wrongArgument('focusDistance', focusDistance, meaning);
    }
  },
  calledFor: ({ aperture, focusDistance }) =>
    aperture === 0 ? null : `a lens of radius ${aperture} is focused at ${focusDistance}`,
  valuesAt: ({ aperture, focusDistance }, { projection: { isOrthographic, focalPx } }) => ({
    aperturePx: focalPx.map((px) => Math.abs(px) * aperture),
    focusDistance,
    isPerspective: isOrthographic ? 0 : 1,
  }),
  // aperture · |z / focusDistance − 1| is at most this at every depth z; half of it is the deviation.
  reach: ({ aperture, focusDistance }) => ({
    displacement: 0,
    growth: 1,
    blur: { atEye: aperture / 2, perDepth: aperture / focusDistance / 2 },
  }),
});
