import type { ScreenCovariance } from '../../../reference/covariance.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import { thinnedOpacity } from '../../../reference/stacked-opacity.ts';
import type { EffectPlace } from '../effect.ts';
import type { DepthOfFieldOptions } from './depth-of-field.ts';

/** MOST_PX of depth-of-field.wgsl. */
const MOST_PX = 1e6;

export const example: DepthOfFieldOptions = { aperture: 0.15, focusDistance: 2.6 };

export function reference(
  { aperture, focusDistance }: DepthOfFieldOptions,
  { projection: { isOrthographic, focalPx } }: EffectPlace,
): EffectReference {
  const blurred = ({ a, b, c, determinant }: ScreenCovariance, depthView: number): ScreenCovariance => {
    // World units, in the plane of the splat.
    const radius = (aperture * Math.abs(depthView - focusDistance)) / focusDistance;
    const [x, y] = focalPx.map((px) => {
      const radiusPx = (Math.abs(px) * radius) / (isOrthographic ? 1 : depthView);
      return Math.min(radiusPx, MOST_PX) ** 2 / 4;
    });
    return { a: a + x, b, c: c + y, determinant: determinant + x * c + y * a + x * y };
  };
  return {
    changeScreen: blurred,
    changeOpacity(opacity, { covariance, depthView }) {
      const { determinant } = blurred(covariance, depthView);
      return thinnedOpacity(opacity, Math.sqrt(covariance.determinant / determinant));
    },
  };
}
