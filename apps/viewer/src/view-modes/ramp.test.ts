import { expect, it } from 'vitest';
import type { Vec3 } from '../state/vec3.ts';
import { VALUE_RAMP } from './ramp.ts';

/** Lightness as people see it, 0…100 (CIE L*). */
function lightness(color: Vec3): number {
  const [red, green, blue] = color.map((value) => {
    const part = value / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 116 * Math.cbrt(0.2126 * red + 0.7152 * green + 0.0722 * blue) - 16;
}

it('rises in lightness in about even steps, over most of what there is', () => {
  const { low, high } = VALUE_RAMP;
  const steps = [0, 0.25, 0.5, 0.75, 1].map((part) =>
    lightness([0, 1, 2].map((c) => low.color[c] + part * (high.color[c] - low.color[c])) as unknown as Vec3),
  );
  for (const [i, step] of steps.slice(1).entries()) expect(step - steps[i]).toBeGreaterThan(12);
  expect(steps[4] - steps[0]).toBeGreaterThan(60);
});
