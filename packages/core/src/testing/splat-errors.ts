import { type Harmonics, readCoefficients } from '../data/packing/harmonics.ts';
import { normalizedRotation } from '../data/packing/rotation.ts';
import { coefficientsPerSplat, type SplatSet } from '../data/splats/splat-set.ts';

/** Largest differences between splats, each of a single value. */
export interface SplatErrors {
  readonly position: number;
  readonly logScale: number;
  /** In radians. */
  readonly angle: number;
  /** Difference of opacities, 0…1. */
  readonly opacity: number;
  readonly colorDc: number;
  /** Difference of coefficients of degree 1. */
  readonly firstHarmonics: number;
  /** Difference of coefficients of degrees 2 and 3. */
  readonly otherHarmonics: number;
}

/** Compares splats of two sets, row by row. NaN differs by NaN. */
export function splatErrors(found: SplatSet<Harmonics>, expected: SplatSet<Harmonics>): SplatErrors {
  if (found.count !== expected.count || found.harmonics.degree !== expected.harmonics.degree)
    throw new Error(`${found.count} splats, not ${expected.count}; or harmonics of another degree`);
  const values = coefficientsPerSplat(found.harmonics.degree);
  const [foundSh, expectedSh] = [new Float64Array(values), new Float64Array(values)];
  const errors = { position: 0, logScale: 0, angle: 0, opacity: 0, colorDc: 0 };
  const harmonics = { firstHarmonics: 0, otherHarmonics: 0 };
  for (let i = 0; i < found.count; i++) {
    for (let k = 0; k < 3; k++) {
      const at = 3 * i + k;
      const away = found.positions[at] + found.origin[k] - (expected.positions[at] + expected.origin[k]);
      errors.position = Math.max(errors.position, Math.abs(away));
      errors.logScale = Math.max(errors.logScale, Math.abs(found.logScales[at] - expected.logScales[at]));
      errors.colorDc = Math.max(errors.colorDc, Math.abs(found.colorDc[at] - expected.colorDc[at]));
    }
    errors.angle = Math.max(errors.angle, angleBetween(found.rotations, expected.rotations, 4 * i));
    const opacity = (set: SplatSet<Harmonics>) => 1 / (1 + Math.exp(-set.opacityLogits[i]));
    errors.opacity = Math.max(errors.opacity, Math.abs(opacity(found) - opacity(expected)));
    readCoefficients(found.harmonics, i, foundSh);
    readCoefficients(expected.harmonics, i, expectedSh);
    for (let k = 0; k < values; k++) {
      const band = k < 9 ? 'firstHarmonics' : 'otherHarmonics';
      harmonics[band] = Math.max(harmonics[band], Math.abs(foundSh[k] - expectedSh[k]));
    }
  }
  return { ...errors, ...harmonics };
}

function angleBetween(a: Float32Array, b: Float32Array, at: number): number {
  const [p, q] = [new Float64Array(4), new Float64Array(4)];
  normalizedRotation(a, at, p);
  normalizedRotation(b, at, q);
  const sign = p.reduce((sum, value, i) => sum + value * q[i], 0) < 0 ? -1 : 1;
  // Not from the cosine, which cannot tell small angles.
  return 4 * Math.asin(Math.min(1, Math.hypot(...p.map((value, i) => value - sign * q[i])) / 2));
}
