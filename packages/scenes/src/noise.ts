import { mix32 } from './prng.ts';

const LATTICE_X = 0x27d4eb2f;
const LATTICE_Y = 0x165667b1;
const LATTICE_Z = 0x1b873593;

/** Uniform in [0, 1) for an integer lattice point. */
export function latticeHash(x: number, y: number, z: number): number {
  return (
    mix32(Math.imul(x, LATTICE_X) ^ Math.imul(y, LATTICE_Y) ^ Math.imul(z, LATTICE_Z) ^ 0x5bd1e995) / 2 ** 32
  );
}

export function clamp01(value: number): number {
  return Math.max(0, Math.min(1, value));
}

export function mix(a: number, b: number, t: number): number {
  return a + (b - a) * t;
}

/** 0 below `low`, 1 above `high`, a cubic with flat ends between. */
export function smoothstep(low: number, high: number, value: number): number {
  const t = clamp01((value - low) / (high - low));
  return t * t * (3 - 2 * t);
}

/** Smooth value noise in [-1, 1] with features one unit wide. */
export function valueNoise(x: number, y: number, z: number): number {
  const ix = Math.floor(x);
  const iy = Math.floor(y);
  const iz = Math.floor(z);
  const fx = fade(x - ix);
  const fy = fade(y - iy);
  const fz = fade(z - iz);
  const near = mix(
    mix(latticeHash(ix, iy, iz), latticeHash(ix + 1, iy, iz), fx),
    mix(latticeHash(ix, iy + 1, iz), latticeHash(ix + 1, iy + 1, iz), fx),
    fy,
  );
  const far = mix(
    mix(latticeHash(ix, iy, iz + 1), latticeHash(ix + 1, iy, iz + 1), fx),
    mix(latticeHash(ix, iy + 1, iz + 1), latticeHash(ix + 1, iy + 1, iz + 1), fx),
    fy,
  );
  return 2 * mix(near, far, fz) - 1;
}

function fade(t: number): number {
  return t * t * (3 - 2 * t);
}

/** Sum of `octaves` of value noise, each twice as fine and half as strong; about [-1, 1]. */
export function fractalNoise(x: number, y: number, z: number, octaves: number): number {
  let sum = 0;
  let amplitude = 0.5;
  let frequency = 1;
  for (let octave = 0; octave < octaves; octave++) {
    // The offset keeps the octaves' lattice planes, where value noise is flat, from coinciding.
    const shift = octave * 17.31;
    sum += amplitude * valueNoise(x * frequency + shift, y * frequency - shift, z * frequency + shift);
    amplitude *= 0.5;
    frequency *= 2;
  }
  return sum;
}

/** Result of {@link cellularNoise} at a point. */
export interface Cell {
  /** Distance to the border between the nearest two cells, about, in cell widths; 0 on the border. */
  border: number;
  /** Uniform in [0, 1), the same all over one cell. */
  id: number;
}

/** Irregular polygons (a jittered Voronoi diagram) with cells about one unit wide, for paving. Writes `cell`. */
export function cellularNoise(x: number, z: number, cell: Cell): void {
  const ix = Math.floor(x);
  const iz = Math.floor(z);
  let nearest = 9;
  let second = 9;
  for (let dz = -1; dz <= 1; dz++) {
    for (let dx = -1; dx <= 1; dx++) {
      const cx = ix + dx;
      const cz = iz + dz;
      const px = cx + 0.15 + 0.7 * latticeHash(cx, 11, cz) - x;
      const pz = cz + 0.15 + 0.7 * latticeHash(cx, 23, cz) - z;
      const distance = Math.sqrt(px * px + pz * pz);
      if (distance < nearest) {
        second = nearest;
        nearest = distance;
        cell.id = latticeHash(cx, 37, cz);
      } else if (distance < second) {
        second = distance;
      }
    }
  }
  cell.border = 0.5 * (second - nearest);
}
