/**
 * A small seeded random-number generator: a 32-bit Weyl sequence through an avalanche mix.
 * `Math.random` cannot be seeded, and a scene has to be the same on every machine for its images to
 * be compared.
 */
export class Prng {
  #state: number;

  constructor(seed: number) {
    this.#state = mix32(seed | 0);
  }

  /** Uniform in [0, 1), with 32 random bits. */
  next(): number {
    // 2^32 divided by the golden ratio, made odd: the increment that spreads a Weyl sequence best.
    this.#state = (this.#state + 0x9e3779b9) | 0;
    return mix32(this.#state) / 2 ** 32;
  }

  /** Uniform in [low, high). */
  range(low: number, high: number): number {
    return low + (high - low) * this.next();
  }

  /**
   * Approximately normal, mean 0 and standard deviation 1, never beyond ±3.5: a sum of four
   * uniforms, whose bounded tails keep a log-normal scale from producing a stray giant.
   */
  gaussian(): number {
    const sum = this.next() + this.next() + this.next() + this.next();
    return (sum - 2) * Math.sqrt(3);
  }
}

/** A bijective avalanche mix of 32 bits; returns an unsigned integer. */
function mix32(value: number): number {
  let bits = value | 0;
  bits = Math.imul(bits ^ (bits >>> 16), 0x7feb352d);
  bits = Math.imul(bits ^ (bits >>> 15), 0x846ca68b);
  return (bits ^ (bits >>> 16)) >>> 0;
}

/** Returns a seed for a named part, so that changes of one part do not affect other parts. */
export function seedFor(seed: number, name: string): number {
  let hash = mix32(seed);
  for (let i = 0; i < name.length; i++) hash = mix32(hash ^ Math.imul(name.charCodeAt(i) + i, 0x01000193));
  return hash;
}
