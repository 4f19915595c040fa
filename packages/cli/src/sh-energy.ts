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

/** Measures the energy of each band of spherical harmonics above 0, of splats in pieces. */
export class ShEnergy {
  readonly #squares: number[] = [];
  #count = 0;

  add({ count, harmonics }: SplatSet<Harmonics>): void {
    const { degree } = harmonics;
    const values = new Float64Array(coefficientsPerSplat(degree));
    while (this.#squares.length < degree) this.#squares.push(0);
    for (let splat = 0; splat < count && degree > 0; splat++) {
      readCoefficients(harmonics, splat, values);
      for (let i = 0; i < degree; i++) {
        const [from, to] = bandRange((i + 1) as ShDegree);
        for (let value = from; value < to; value++) this.#squares[i] += values[value] ** 2;
      }
    }
    this.#count += count;
  }

  bands(): ShBand[] {
    return this.#squares.map((square, i) => {
      const band = (i + 1) as ShDegree;
      const [from, to] = bandRange(band);
      return { band, rms: this.#count === 0 ? 0 : Math.sqrt(square / (this.#count * (to - from))) };
    });
  }
}

/** Range of band `degree` among the 3K values of a splat. */
function bandRange(degree: ShDegree): [number, number] {
  return [coefficientsPerSplat((degree - 1) as ShDegree), coefficientsPerSplat(degree)];
}
