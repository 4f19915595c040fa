import { checkGrade, type GradeOptions, gradeMatrix } from '../math/grade-matrix.ts';
import type { Harmonics } from '../packing/harmonics.ts';
import { givenSet } from '../splats/check-set.ts';
import { colorDcOf, colorOf } from '../splats/color-values.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { trainedCoefficients } from './limit-degree.ts';

/**
 * Writes a grade into the colours of splats, exactly as the effect `grade` draws it: a linear map of
 * colours is the same map of all their harmonics. The effects `brightness` and `fog` cannot be
 * written so, since they are not linear in encoded colours or depend on the camera.
 *
 * @returns the set itself if the grade changes nothing.
 * @throws InvalidArgumentError that names the option out of range.
 * @example
 * const set = await readSplats('/robot.ply', { shPrecision: 'f32' });
 * const bytes = await writeSplats(gradeSplats(set, { exposure: 0.5 }), 'spz');
 */
export function gradeSplats(set: SplatSet<Harmonics>, options: GradeOptions): SplatSet<Harmonics> {
  checkGrade(options);
  givenSet(set);
  const matrix = gradeMatrix(options);
  if (matrix.every((value, i) => value === (i % 4 === 0 ? 1 : 0))) return set;
  const colorDc = Float32Array.from(mapped(set.colorDc.map(colorOf), matrix), colorDcOf);
  const coefficients = mapped(trainedCoefficients(set), matrix);
  return { ...set, colorDc, harmonics: { degree: set.harmonics.degree, coefficients } };
}

/** Each red, green and blue times the matrix, in float64. */
function mapped(colors: Float32Array, m: Float64Array): Float32Array {
  const graded = new Float32Array(colors.length);
  for (let i = 0; i < colors.length; i += 3) {
    const [r, g, b] = [colors[i], colors[i + 1], colors[i + 2]];
    for (let row = 0; row < 3; row++)
      graded[i + row] = m[3 * row] * r + m[3 * row + 1] * g + m[3 * row + 2] * b;
  }
  return graded;
}
