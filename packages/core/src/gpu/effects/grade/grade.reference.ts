import { type GradeOptions, gradeMatrix } from '../../../data/math/grade-matrix.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';

export const example: GradeOptions = { exposure: 0.4, saturation: 1.5, temperature: -0.6, tint: 0.3 };

export function reference(options: GradeOptions): EffectReference {
  const m = gradeMatrix(options);
  const mapped = (row: number, [r, g, b]: readonly [number, number, number]) =>
    m[3 * row] * r + m[3 * row + 1] * g + m[3 * row + 2] * b;
  return { changeColor: (color) => [mapped(0, color), mapped(1, color), mapped(2, color)] };
}
