import { coefficientsPerSplat, encodePly, type ShDegree, type SplatSet } from '@websplatter/core';
import type { SceneCamera } from './builtin-scenes.ts';
import { SplatBuilder } from './splat-builder.ts';

/**
 * A small seeded random-number generator: a 32-bit Weyl sequence through an avalanche mix.
 * `Math.random` cannot be seeded, and a scene has to be the same on every machine for its images to
 * be compared.
 */
class Prng {
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
function seedFor(seed: number, name: string): number {
  let hash = mix32(seed);
  for (let i = 0; i < name.length; i++) hash = mix32(hash ^ Math.imul(name.charCodeAt(i) + i, 0x01000193));
  return hash;
}

/** Fewest splats of a synthetic scene. */
export const SYNTHETIC_MIN_SPLATS = 10_000;
/** Most splats of a synthetic scene. */
export const SYNTHETIC_MAX_SPLATS = 16_000_000;

/** Options of `syntheticPly`. */
export interface SyntheticOptions {
  /** Exact number of splats, {@link SYNTHETIC_MIN_SPLATS} to {@link SYNTHETIC_MAX_SPLATS}. */
  readonly splats: number;
  /** Any integer; the same seed gives the same bytes on the same engine. Default 1. */
  readonly seed?: number;
  /** Degree of the spherical harmonics; default 3. */
  readonly shDegree?: ShDegree;
}

/** Camera of a synthetic scene's measured frames; nothing stands in the way of an orbit. */
export const syntheticCamera: SceneCamera = {
  name: 'front',
  position: [0.6, 2.2, 6.4],
  target: [0, 1, 0],
  up: [0, 1, 0],
  fovYDegrees: 50,
  near: 0.1,
  far: 200,
};

/** Splats that are made, encoded and handed on together: 4 MB at degree 3. */
const PIECE_SPLATS = 16_384;

/**
 * Streams a PLY of random splats for measurements: a frame costs about as much as of a captured scene
 * with the same number of splats. Only one piece is in memory at a time, so memory does not depend on
 * the number. Metres, y up: an object 2.4 m across, clumps around it, ground out to 12 m, and a dome
 * at 40 to 80 m.
 *
 * @throws RangeError if `splats` is not a whole number in range.
 */
export function syntheticPly(options: SyntheticOptions): ReadableStream<Uint8Array<ArrayBuffer>> {
  const { splats, seed = 1, shDegree = 3 } = options;
  if (!Number.isInteger(splats) || splats < SYNTHETIC_MIN_SPLATS || splats > SYNTHETIC_MAX_SPLATS) {
    throw new RangeError(
      `syntheticPly: splats is ${splats}; give a whole number from ${SYNTHETIC_MIN_SPLATS} to ${SYNTHETIC_MAX_SPLATS}.`,
    );
  }
  const maker = new SplatMaker(splats, seed, shDegree);
  let made = 0;
  return new ReadableStream<Uint8Array<ArrayBuffer>>(
    {
      pull(controller) {
        const count = Math.min(PIECE_SPLATS, splats - made);
        const { header, rows } = splitPly(encodePly(maker.make(count, made / PIECE_SPLATS)));
        if (made === 0) {
          const whole = header.replace(`element vertex ${count}\n`, `element vertex ${splats}\n`);
          controller.enqueue(new TextEncoder().encode(whole));
        }
        controller.enqueue(rows);
        made += count;
        if (made === splats) controller.close();
      },
    },
    // Make each piece only when it is read.
    { highWaterMark: 0 },
  );
}

const END_OF_HEADER = 'end_header\n';
/** Longer than any header of `encodePly`. */
const HEADER_BYTES = 4096;

function splitPly(ply: Uint8Array<ArrayBuffer>): { header: string; rows: Uint8Array<ArrayBuffer> } {
  const start = new TextDecoder('latin1').decode(ply.subarray(0, HEADER_BYTES));
  const length = start.indexOf(END_OF_HEADER) + END_OF_HEADER.length;
  return { header: start.slice(0, length), rows: ply.subarray(length) };
}

type Vector = [x: number, y: number, z: number];

/** Position, normal and colour of one splat; an output parameter. */
interface Place {
  readonly position: Vector;
  readonly normal: Vector;
  readonly color: Vector;
}

/** A kind of object in the scene. */
interface Kind {
  /** Part of all splats, 0…1; the shares of all kinds add up to 1. */
  readonly share: number;
  /** Area that its splats cover together, m²: more splats are smaller. */
  readonly areaM2: number;
  /** Spread of the splats' sizes, as a natural logarithm. */
  readonly sizeSpread: number;
  /** Thickness of a splat as a part of its width. */
  readonly flatness: number;
  /** Part of the splats that are long and thin. */
  readonly needles: number;
  /** Part of the splats that are nearly opaque; the others are faint. */
  readonly opaque: number;
  readonly place: (prng: Prng, to: Place) => void;
}

const GROUND_RADIUS_M = 12;
const DOME_M = [40, 80] as const;
const CORE_RADIUS_M = 1.2;

/** Half-axes and centres of the clumps: clear of the ring that `syntheticCamera` moves on. */
const CLUMPS = Array.from({ length: 24 }, (_, i) => {
  const prng = new Prng(seedFor(i, 'clump'));
  const isNear = i < 10;
  const distance = isNear ? prng.range(2.4, 4.2) : prng.range(8.4, 11);
  const angle = prng.range(0, 2 * Math.PI);
  const width = isNear ? prng.range(0.25, 0.6) : prng.range(0.6, 1.3);
  const height = isNear ? prng.range(0.3, 0.8) : prng.range(0.8, 1.8);
  return { x: distance * Math.cos(angle), z: distance * Math.sin(angle), width, height };
});

// Shares, spreads and the two opacities are similar to captured scenes.
const KINDS: readonly Kind[] = [
  {
    share: 0.3,
    areaM2: Math.PI * GROUND_RADIUS_M ** 2,
    sizeSpread: 0.45,
    flatness: 0.15,
    needles: 0.04,
    opaque: 0.65,
    place(prng, { position, normal, color }) {
      const [distance, angle] = [GROUND_RADIUS_M * Math.sqrt(prng.next()), prng.range(0, 2 * Math.PI)];
      set(position, distance * Math.cos(angle), 0.01 * prng.gaussian(), distance * Math.sin(angle));
      set(normal, 0.1 * prng.gaussian(), 1, 0.1 * prng.gaussian());
      const shade = 0.4 + 0.15 * Math.sin(3 * position[0]) * Math.sin(3 * position[2]);
      set(color, shade, shade, 0.8 * shade);
    },
  },
  {
    share: 0.42,
    areaM2: 260,
    sizeSpread: 0.5,
    flatness: 0.2,
    needles: 0.12,
    opaque: 0.55,
    place(prng, { position, normal, color }) {
      const { x, z, width, height } = CLUMPS[Math.floor(prng.next() * CLUMPS.length)];
      direction(prng, normal);
      // Denser towards the outside, as leaves are.
      const reach = prng.next() ** 0.25;
      const y = height * (1 + reach * normal[1]);
      set(position, x + width * reach * normal[0], y, z + width * reach * normal[2]);
      direction(prng, normal);
      const shade = 0.7 + 0.2 * prng.gaussian();
      set(color, 0.2 * shade, 0.45 * shade, 0.15 * shade);
    },
  },
  {
    share: 0.2,
    areaM2: 4 * Math.PI * CORE_RADIUS_M ** 2,
    sizeSpread: 0.45,
    flatness: 0.15,
    needles: 0.06,
    opaque: 0.65,
    place(prng, { position, normal, color }) {
      direction(prng, normal);
      const [x, y, z] = normal;
      const radius = CORE_RADIUS_M * (1 + 0.08 * Math.sin(9 * x) * Math.sin(7 * y) * Math.cos(8 * z));
      set(position, radius * x, CORE_RADIUS_M + radius * y, radius * z);
      set(color, 0.5 + 0.4 * Math.sin(6 * x), 0.45 + 0.3 * Math.sin(5 * y), 0.5 - 0.4 * Math.sin(6 * z));
    },
  },
  {
    share: 0.08,
    areaM2: 4 * Math.PI * 60 ** 2,
    sizeSpread: 0.55,
    flatness: 0.3,
    needles: 0.04,
    opaque: 0.65,
    place(prng, { position, normal, color }) {
      direction(prng, normal);
      const distance = prng.range(...DOME_M);
      const up = Math.abs(normal[1]);
      set(position, distance * normal[0], distance * up, distance * normal[2]);
      set(color, 0.4 + 0.2 * up, 0.45 + 0.25 * up, 0.5 + 0.4 * up);
    },
  },
];

/** Standard deviation of the coefficients by band from 1; mostly common to all colours. */
const BAND_DEVIATIONS = [0.14, 0.07, 0.035] as const;
/** Natural logarithm of a splat's width over the width that its share of the surface needs. */
const COVERAGE = Math.log(0.5);
/** Value of the basis function of degree 0. */
const SH_C0 = 0.5 / Math.sqrt(Math.PI);

/** Makes the splats of one scene, piece by piece. */
class SplatMaker {
  readonly #splats: number;
  readonly #seed: number;
  readonly #degree: ShDegree;
  readonly #place: Place = { position: [0, 0, 0], normal: [0, 1, 0], color: [0, 0, 0] };
  readonly #frame = new Float64Array(9);
  readonly #scales = new Float64Array(3);
  readonly #coefficients: Float64Array;

  constructor(splats: number, seed: number, degree: ShDegree) {
    this.#splats = splats;
    this.#seed = seed;
    this.#degree = degree;
    this.#coefficients = new Float64Array(3 + coefficientsPerSplat(degree));
  }

  /** Every piece has random numbers of its own, and splats of all kinds. */
  make(count: number, piece: number): SplatSet {
    const prng = new Prng(seedFor(this.#seed, `piece ${piece}`));
    const builder = new SplatBuilder(count, this.#degree);
    const { position, normal, color } = this.#place;
    for (let i = 0; i < count; i++) {
      const kind = kindAt(prng.next());
      kind.place(prng, this.#place);
      orient(normal, prng.range(0, 2 * Math.PI), this.#frame);
      this.#setScales(kind, prng);
      this.#setCoefficients(color, prng);
      const logit = prng.next() < kind.opaque ? 3.2 + 1.6 * prng.gaussian() : -1.6 + 1.1 * prng.gaussian();
      const opacity = 1 / (1 + Math.exp(-logit));
      builder.add(...position, this.#frame, this.#scales, opacity, this.#coefficients);
    }
    return builder.build();
  }

  #setScales({ share, areaM2, sizeSpread, flatness, needles }: Kind, prng: Prng): void {
    const mean = COVERAGE + 0.5 * Math.log(areaM2 / (share * this.#splats)) + sizeSpread * prng.gaussian();
    const stretch = prng.next() < needles ? 1 + 0.5 * Math.abs(prng.gaussian()) : 0;
    this.#scales[0] = Math.exp(mean + 0.35 * prng.gaussian() + stretch);
    this.#scales[1] = Math.exp(mean + 0.35 * prng.gaussian() - stretch);
    this.#scales[2] = Math.exp(mean + Math.log(flatness) + 0.5 * prng.gaussian());
  }

  #setCoefficients(color: Vector, prng: Prng): void {
    for (let channel = 0; channel < 3; channel++) {
      this.#coefficients[channel] = (color[channel] + 0.05 * prng.gaussian() - 0.5) / SH_C0;
    }
    let at = 3;
    for (let band = 1; band <= this.#degree; band++) {
      const deviation = BAND_DEVIATIONS[band - 1];
      for (let order = -band; order <= band; order++) {
        const common = deviation * prng.gaussian();
        for (let channel = 0; channel < 3; channel++) {
          this.#coefficients[at++] = common + 0.3 * deviation * prng.gaussian();
        }
      }
    }
  }
}

function kindAt(uniform: number): Kind {
  let sum = 0;
  for (const kind of KINDS) {
    sum += kind.share;
    if (uniform < sum) return kind;
  }
  return KINDS[KINDS.length - 1];
}

function set(vector: Vector, x: number, y: number, z: number): void {
  vector[0] = x;
  vector[1] = y;
  vector[2] = z;
}

/** Writes a uniformly distributed direction. */
function direction(prng: Prng, out: Vector): void {
  const y = prng.range(-1, 1);
  const angle = prng.range(0, 2 * Math.PI);
  const radius = Math.sqrt(1 - y * y);
  set(out, radius * Math.cos(angle), y, radius * Math.sin(angle));
}

/** Writes axes for a flat splat that faces `normal`, turned about it by `angle`: z along it. */
function orient(normal: Vector, angle: number, frame: Float64Array): void {
  const length = Math.hypot(...normal);
  const [nx, ny, nz] = [normal[0] / length, normal[1] / length, normal[2] / length];
  // An axis that is not parallel to the normal.
  const isSteep = Math.abs(ny) >= 0.9;
  const [tx, ty, tz] = isSteep ? [0, nz, -ny] : [-nz, 0, nx];
  const across = Math.hypot(tx, ty, tz);
  const [cos, sin] = [Math.cos(angle) / across, Math.sin(angle) / across];
  const [bx, by, bz] = [ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx];
  const [ux, uy, uz] = [cos * tx + sin * bx, cos * ty + sin * by, cos * tz + sin * bz];
  frame[0] = ux;
  frame[1] = uy;
  frame[2] = uz;
  frame[3] = ny * uz - nz * uy;
  frame[4] = nz * ux - nx * uz;
  frame[5] = nx * uy - ny * ux;
  frame[6] = nx;
  frame[7] = ny;
  frame[8] = nz;
}
