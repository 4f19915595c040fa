import {
  coefficientsPerSplat,
  type Harmonics,
  readCoefficients,
  type ShDegree,
  type SplatSet,
} from '@websplatter/core';

export interface ShBand {
  /** 1, 2 or 3. */
  readonly band: number;
  /** Root mean square of the band's coefficients over all splats and colour channels. */
  readonly rms: number;
}

/** Measures the energy of each band of spherical harmonics above 0. */
export function shEnergyPerBand({ count, harmonics }: SplatSet<Harmonics>): ShBand[] {
  const degrees = Array.from({ length: harmonics.degree }, (_, i) => (i + 1) as ShDegree);
  const squares = degrees.map(() => 0);
  const values = new Float64Array(coefficientsPerSplat(harmonics.degree));
  for (let splat = 0; splat < count && harmonics.degree > 0; splat++) {
    readCoefficients(harmonics, splat, values);
    degrees.forEach((degree, i) => {
      const [from, to] = bandRange(degree);
      for (let value = from; value < to; value++) squares[i] += values[value] ** 2;
    });
  }
  return degrees.map((degree, i) => {
    const [from, to] = bandRange(degree);
    return { band: degree, rms: count === 0 ? 0 : Math.sqrt(squares[i] / (count * (to - from))) };
  });
}

/** Range of band `degree` among the 3K values of a splat. */
function bandRange(degree: ShDegree): [number, number] {
  return [coefficientsPerSplat((degree - 1) as ShDegree), coefficientsPerSplat(degree)];
}
