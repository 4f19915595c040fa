/** What stands in the vase: pampas plumes of fine hair, and reeds; and the pear's stem. */
import { PLUME_BARE, PLUMES, plumeStem, VASE } from './arrangement.ts';
import { emitFibres } from './fibres.ts';
import { KEY_DIRECTION } from './lighting.ts';
import { clamp01, latticeHash, mix } from './noise.ts';
import type { Part } from './part.ts';

const STRAND_SEGMENTS = 3;
const STRAND_LENGTH_M = 0.085;
const PLUME_CREAM = [0.72, 0.56, 0.38] as const;
const PLUME_ROSE = [0.5, 0.31, 0.23] as const;
const STEM_COLOR = [0.4, 0.33, 0.14] as const;
const STEM_SEGMENTS = 10;

/** A strand's root on its stem and its direction, remembered while its segments are placed. */
class StrandPlacer {
  readonly #stem = new Float64Array(3);
  readonly #ahead = new Float64Array(3);
  readonly #direction = new Float64Array(3);
  #strand = -1;
  #length = 0;
  #droop = 0;
  /** 0: on the side away from the key light, 1: towards it. */
  towardsKey = 0;

  place(strand: number, t: number, out: Float64Array): void {
    if (strand !== this.#strand) this.#start(strand);
    const reach = this.#length * t;
    for (let k = 0; k < 3; k++) out[k] = this.#stem[k] + this.#direction[k] * reach;
    out[1] -= this.#droop * t * t;
  }

  #start(strand: number): void {
    this.#strand = strand;
    const plume = PLUMES[strand % PLUMES.length];
    const along = latticeHash(strand, 1, 1);
    const t = PLUME_BARE + (1 - PLUME_BARE) * along;
    plumeStem(plume, t, this.#stem);
    plumeStem(plume, t + 0.01, this.#ahead);
    const angle = 2 * Math.PI * latticeHash(strand, 2, 1);
    const tangent = normalized(
      this.#ahead[0] - this.#stem[0],
      this.#ahead[1] - this.#stem[1],
      this.#ahead[2] - this.#stem[2],
    );
    const sideX = Math.cos(angle);
    const sideZ = Math.sin(angle);
    // Strands open widest below the middle and close towards the tip, as the plume's outline does.
    const open = mix(0.62, 0.3, along) * (0.45 + 0.75 * latticeHash(strand, 3, 1));
    const direction = normalized(tangent[0] + sideX * open, tangent[1], tangent[2] + sideZ * open);
    this.#direction.set(direction);
    const profile = mix(0.35, 1, Math.sqrt(clamp01(along * 6))) * mix(1, 0.42, along * along);
    this.#length = STRAND_LENGTH_M * profile * (0.7 + 0.6 * latticeHash(strand, 4, 1));
    this.#droop = this.#length * 0.4 * latticeHash(strand, 5, 1);
    this.towardsKey = 0.5 + 0.5 * (sideX * KEY_DIRECTION[0] + sideZ * KEY_DIRECTION[2]);
  }
}

function normalized(x: number, y: number, z: number): [number, number, number] {
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

const REED_SEGMENTS = 14;
const REED_COUNT_AT_FULL = 24;
const REED_GREEN = [0.17, 0.24, 0.06] as const;
const REED_STRAW = [0.45, 0.36, 0.13] as const;

/** A blade that rises from the vase's mouth and bends over under its weight. */
function placeReed(reed: number, t: number, out: Float64Array): void {
  const azimuth = 2 * Math.PI * ((reed * 0.618034) % 1) + 0.6 * latticeHash(reed, 1, 5);
  const length = mix(0.22, 0.42, latticeHash(reed, 2, 5));
  const lean = mix(0.2, 0.55, latticeHash(reed, 3, 5));
  const bend = mix(0.04, 0.2, latticeHash(reed, 4, 5));
  const outX = Math.cos(azimuth);
  const outZ = Math.sin(azimuth);
  const outwards = 0.018 + length * (lean * t + bend * t * t);
  out[0] = VASE[0] + outX * outwards;
  out[1] = 0.255 + length * (Math.sqrt(1 - lean * lean) * t - 1.1 * bend * t * t * t);
  out[2] = VASE[2] + outZ * outwards;
}

export const plumeParts: readonly Part[] = [
  {
    name: 'plume-stems',
    weight: 50 * STEM_SEGMENTS,
    emit: (count, studio) => {
      // A few fibres side by side make one stem.
      emitFibres(count, studio, {
        segments: STEM_SEGMENTS,
        radius: 0.0011,
        color: STEM_COLOR,
        gloss: 0.05,
        opacity: [0.85, 0.98],
        owner: 'plumes',
        place: (fibre, t, out) => {
          plumeStem(PLUMES[fibre % PLUMES.length], t * 0.97, out);
          out[0] += 0.0012 * (latticeHash(fibre, 1, 2) - 0.5);
          out[2] += 0.0012 * (latticeHash(fibre, 2, 2) - 0.5);
        },
      });
    },
  },
  {
    name: 'plumes',
    weight: 24_000,
    role: 'sparse',
    work: 0.5,
    emit: (count, studio) => {
      const strand = new StrandPlacer();
      emitFibres(count, studio, {
        segments: STRAND_SEGMENTS,
        radius: 0.00034,
        color: (fibre, t, out) => {
          const tone = clamp01(0.25 + 0.55 * t + 0.5 * (latticeHash(fibre, 9, 1) - 0.5));
          for (let k = 0; k < 3; k++) out[k] = mix(PLUME_ROSE[k], PLUME_CREAM[k], tone);
        },
        gloss: 0.1,
        opacity: [0.25, 0.85],
        owner: 'plumes',
        place: (fibre, t, out) => strand.place(fibre, t, out),
        exposure: (_, t) => clamp01(0.25 + 0.45 * t + 0.45 * strand.towardsKey),
      });
    },
  },
  {
    name: 'reeds',
    weight: REED_COUNT_AT_FULL * REED_SEGMENTS * 3,
    emit: (count, studio) => {
      emitFibres(count, studio, {
        segments: REED_SEGMENTS,
        radius: 0.0011,
        color: (fibre, t, out) => {
          const dry = clamp01(t * 1.1 - 0.35 + 0.7 * latticeHash(fibre % REED_COUNT_AT_FULL, 6, 5));
          for (let k = 0; k < 3; k++) out[k] = mix(REED_GREEN[k], REED_STRAW[k], dry);
        },
        gloss: 0.14,
        opacity: [0.8, 0.98],
        owner: 'plumes',
        place: (fibre, t, out) => {
          placeReed(fibre % REED_COUNT_AT_FULL, t, out);
          // Three strips side by side make a blade's width.
          const strip = Math.floor(fibre / REED_COUNT_AT_FULL) % 3;
          out[0] += (strip - 1) * 0.0014 * (1 - t);
        },
        exposure: (_, t) => 0.45 + 0.55 * t,
      });
    },
  },
];
