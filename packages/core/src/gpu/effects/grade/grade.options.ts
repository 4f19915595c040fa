import type { GradeOptions } from '../../../data/math/grade-matrix.ts';
import { effectOptions } from '../../../options/effect-options.ts';
import { grade } from './grade.ts';

/** All but the exposure in percent. */
type GradeValues = Required<GradeOptions>;

export const options = effectOptions<GradeOptions, GradeValues>(
  grade,
  {
    exposure: { kind: 'number', label: 'Exposure', unit: 'stops', range: () => [-3, 3], first: () => 0 },
    saturation: {
      kind: 'number',
      label: 'Saturation',
      unit: 'percent',
      range: () => [0, 300],
      first: () => 120,
    },
    temperature: {
      kind: 'number',
      label: 'Temperature, blue to orange',
      unit: 'percent',
      range: () => [-100, 100],
      first: () => 0,
    },
    tint: {
      kind: 'number',
      label: 'Tint, green to magenta',
      unit: 'percent',
      range: () => [-100, 100],
      first: () => 0,
    },
  },
  ({ exposure, saturation, temperature, tint }) => ({
    exposure,
    saturation: saturation / 100,
    temperature: temperature / 100,
    tint: tint / 100,
  }),
);
