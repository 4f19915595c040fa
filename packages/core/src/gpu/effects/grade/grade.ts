import { checkGrade, type GradeOptions, gradeMatrix } from '../../../data/math/grade-matrix.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { effectFunction } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import wgsl from './grade.wgsl?raw';

export type { GradeOptions };

/**
 * Grades colours: exposure, saturation and white balance, as one linear map of sRGB-encoded values.
 * `gradeSplats` writes the same map into splats.
 *
 * @example
 * const clouds = [{ cloud, effects: [grade({ exposure: 0.5, saturation: 1.2, temperature: -0.2 })] }];
 */
export const grade = /* @__PURE__ */ effectFunction<
  GradeOptions,
  { red: 'vec3f'; green: 'vec3f'; blue: 'vec3f' }
>({
  ...EFFECT_LIST.grade,
  wgsl,
  fields: { red: 'vec3f', green: 'vec3f', blue: 'vec3f' },
  check: checkGrade,
  calledFor({ exposure = 0, saturation = 1, temperature = 0, tint = 0 }) {
    const isNeutral = exposure === 0 && saturation === 1 && temperature === 0 && tint === 0;
    return isNeutral
      ? null
      : `exposure ${exposure} stops, saturation ${saturation}, temperature ${temperature}, tint ${tint}`;
  },
  valuesAt(options) {
    const m = gradeMatrix(options);
    const row = (i: number) => Array.from(m.subarray(3 * i, 3 * i + 3)) as unknown as Vec3;
    return { red: row(0), green: row(1), blue: row(2) };
  },
});
