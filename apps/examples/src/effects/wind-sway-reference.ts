import type { Vec3 } from '@websplatter/core';
import type { EffectPlace } from '@websplatter/core/effects';
import type { EffectReference } from '@websplatter/core/reference';
import type { WindSwayOptions } from './wind-sway.ts';

/** Computes `windSway` in float64 from its options only. Tests compare the shader with it. */
export function windSwayReference(options: WindSwayOptions, { origin }: EffectPlace): EffectReference {
  const { amplitude, timeS, periodS = 3, waveLength = 1, ground = 0, tall = 1 } = options;
  const { direction = [1, 0, 0], up = [0, 1, 0] } = options;
  const along = (axis: Vec3, point: readonly number[]) =>
    point.reduce((sum, coordinate, i) => sum + coordinate * axis[i], 0) / Math.hypot(...axis);
  return {
    changeSplat(splat) {
      const point = splat.position.map((coordinate, i) => coordinate + origin[i]);
      const part = Math.min(1, Math.max(0, (along(up, point) - ground) / tall));
      const turns = along(direction, point) / waveLength - timeS / periodS;
      const far = amplitude * part * part * (3 - 2 * part) * Math.sin(2 * Math.PI * turns);
      const [x, y, z] = splat.position.map(
        (coordinate, i) => coordinate + (far * direction[i]) / Math.hypot(...direction),
      );
      return { ...splat, position: [x, y, z] };
    },
  };
}
