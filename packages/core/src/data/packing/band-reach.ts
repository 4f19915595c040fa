import { coefficientsPerSplat, type ShDegree, type TrainedHarmonics } from '../splats/splat-set.ts';
import { type Harmonics, isPacked, isPalette, type PackedHarmonics, readCoefficients } from './harmonics.ts';

/**
 * For each band 1…degree, the most that it can change any colour channel of any splat, in any
 * direction: at least 0, in units of the colours (0…1 from black to white).
 *
 * Band l adds Σ cₘYₗₘ(d) to a channel. By Cauchy–Schwarz that is at most ‖c‖·√(Σ Yₗₘ(d)²), and by
 * the addition theorem the sum is (2l + 1)/4π in every direction d. So √((2l + 1)/4π)·‖c‖ is never
 * exceeded, and it is reached where c is a multiple of Yₗ at some direction; no function of the
 * band stays below 1/√(2l + 1) of it, its root mean square.
 */
export function shBandReach(harmonics: Harmonics, count: number): readonly number[] {
  if (isPacked(harmonics) && harmonics.bandReach) return harmonics.bandReach;
  const stride = coefficientsPerSplat(harmonics.degree);
  const meter = new ShReachMeter(harmonics.degree);
  if (isPalette(harmonics)) {
    // A file may have entries that no splat has.
    for (const entry of new Set(harmonics.indices)) meter.include(harmonics.entries, entry * stride);
    return meter.reaches();
  }
  const floats = floatsOf(harmonics);
  if (floats) {
    for (let i = 0; i < count; i++) meter.include(floats, i * stride);
  } else {
    const values = new Float64Array(stride);
    for (let i = 0; i < count; i++) {
      readCoefficients(harmonics, i, values);
      meter.include(values, 0);
    }
  }
  return meter.reaches();
}

/** The coefficients of all splats where they are float32 in memory, not copied. */
function floatsOf(harmonics: TrainedHarmonics | PackedHarmonics): Float32Array | null {
  if (!isPacked(harmonics)) return harmonics.coefficients;
  const { precision, words } = harmonics;
  return precision === 'f32' ? new Float32Array(words.buffer, words.byteOffset, words.length) : null;
}

/** Measures `shBandReach` of splats that arrive one by one. */
export class ShReachMeter {
  /** Largest sum of squares of one channel's coefficients so far, by band. */
  readonly #squares: number[];

  constructor(degree: ShDegree) {
    this.#squares = Array.from({ length: degree }, () => 0);
  }

  /** Takes one splat's 3K values, from `start` on, as float32 stores them. */
  include(values: Float32Array | Float64Array, start: number): void {
    let at = start;
    for (let i = 0; i < this.#squares.length; i++) {
      const coefficients = 2 * i + 3;
      let red = 0;
      let green = 0;
      let blue = 0;
      for (const end = at + 3 * coefficients; at < end; at += 3) {
        const r = Math.fround(values[at]);
        const g = Math.fround(values[at + 1]);
        const b = Math.fround(values[at + 2]);
        red += r * r;
        green += g * g;
        blue += b * b;
      }
      const largest = Math.max(red, green, blue);
      if (largest > this.#squares[i]) this.#squares[i] = largest;
    }
  }

  /** `shBandReach` of all splats included so far. */
  reaches(): number[] {
    return reachesOf(this.#squares);
  }
}

/** `shBandReach` of the largest sum of squares of one channel's coefficients, by band. */
export function reachesOf(squares: readonly number[]): number[] {
  return squares.map((sum, i) => Math.sqrt(((2 * i + 3) / (4 * Math.PI)) * sum));
}
