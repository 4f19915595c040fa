/** A striped linen runner that lies in folds under the bowl and hangs over the table's edge, and its fringe. */
import { FOOTPRINTS, TABLE_RADIUS } from './arrangement.ts';
import { emitFibres } from './fibres.ts';
import { clamp01, latticeHash, smoothstep, valueNoise } from './noise.ts';
import { type Part, surfacePart } from './part.ts';
import type { Finish } from './shading.ts';
import { BentSheet, type SurfacePoint } from './surface-sampling.ts';

const WIDTH_M = 0.36;
const LENGTH_M = 0.86;
const CENTER_X = 0.07;
const CENTER_Z = 0.26;
/** The runner lies a little askew. */
const ASKEW = (-15 * Math.PI) / 180;
const THICKNESS_M = 0.0022;
const EDGE_RADIUS_M = 0.02;

/** Height of the folds above the table, metres, at the runner's point (a, b). */
function folds(a: number, b: number, x: number, z: number): number {
  let height = 0.0007 * valueNoise(a * 28, 1, b * 28);
  height +=
    ridge(a - 0.085 + 0.22 * b + 0.012 * Math.sin(b * 21), 0.012) * 0.0115 * smoothstep(-0.2, 0.15, b);
  height +=
    ridge(a + 0.115 - 0.1 * b + 0.01 * Math.sin(b * 17 + 1), 0.01) * 0.0085 * smoothstep(-0.1, 0.2, b);
  height += ridge(a + 0.02 + 0.45 * (b - 0.12), 0.009) * 0.005 * smoothstep(-0.02, 0.1, b);
  height += ridge(b + 0.33 - 0.5 * a, 0.011) * 0.006;
  let free = 1;
  for (const footprint of FOOTPRINTS) {
    const distance = Math.hypot(x - footprint.x, z - footprint.z);
    free = Math.min(free, smoothstep(footprint.radius, footprint.radius + 0.05, distance));
  }
  return THICKNESS_M + Math.max(0, height) * free;
}

function ridge(distance: number, width: number): number {
  return Math.exp(-((distance / width) ** 2));
}

/** How far inside the runner's outline a point of the table lies, in metres; negative outside. */
export function clothInset(x: number, z: number): number {
  const a = (x - CENTER_X) * Math.cos(ASKEW) - (z - CENTER_Z) * Math.sin(ASKEW);
  const b = (x - CENTER_X) * Math.sin(ASKEW) + (z - CENTER_Z) * Math.cos(ASKEW);
  return Math.min(WIDTH_M / 2 - Math.abs(a), LENGTH_M / 2 - Math.abs(b));
}

/** Writes the place of the runner's point (a, b): on the table inside its edge, hanging outside it. */
function placeCloth(a: number, b: number, out: Float64Array): void {
  const x = CENTER_X + a * Math.cos(ASKEW) + b * Math.sin(ASKEW);
  const z = CENTER_Z - a * Math.sin(ASKEW) + b * Math.cos(ASKEW);
  const fromMiddle = Math.hypot(x, z);
  const height = folds(a, b, x, z);
  const over = fromMiddle - (TABLE_RADIUS - 0.01);
  if (over <= 0) {
    out[0] = x;
    out[1] = height;
    out[2] = z;
    return;
  }
  const quarter = (EDGE_RADIUS_M * Math.PI) / 2;
  const bend = Math.min(over / EDGE_RADIUS_M, Math.PI / 2);
  const drop = Math.max(0, over - quarter);
  const swing = 0.3 * drop * (0.35 + Math.sin(a * 44 + 0.6) * 0.6 + 0.25 * Math.sin(a * 97));
  const radius = TABLE_RADIUS - 0.01 + (EDGE_RADIUS_M + height) * Math.sin(bend) + swing;
  out[0] = (x / fromMiddle) * radius;
  out[1] = height * Math.cos(bend) - EDGE_RADIUS_M * (1 - Math.cos(bend)) - drop;
  out[2] = (z / fromMiddle) * radius;
}

export const LINEN = [0.7, 0.64, 0.53] as const;
const INDIGO = [0.09, 0.14, 0.27] as const;

/** Splats further apart than this are too long for the bend at the table's edge if stretched. */
const COARSE_WEAVE_M = 0.01;

/** Share of indigo, 0 to 1; stripes fade where splats are too far apart to keep their edges. */
function stripe(a: number, spacing: number): number {
  const fromSide = WIDTH_M / 2 - Math.abs(a);
  const broad = smoothstep(0.028, 0.03, fromSide) * (1 - smoothstep(0.046, 0.048, fromSide));
  const narrow = smoothstep(0.054, 0.0555, fromSide) * (1 - smoothstep(0.059, 0.0605, fromSide));
  return Math.max(broad * clamp01(0.018 / spacing), narrow * clamp01(0.007 / spacing));
}

function clothFinish({ spacing, localX: a, localZ: b, y, normalY }: SurfacePoint, finish: Finish): void {
  const weave = valueNoise(a * 900, 1, b * 70) + valueNoise(a * 70, 2, b * 900);
  const slubs = valueNoise(a * 30, 3, b * 420);
  finish.setAlbedo(LINEN);
  finish.blendAlbedo(INDIGO, 0.88 * stripe(a, spacing));
  finish.scaleAlbedo(1 + 0.05 * weave + 0.06 * slubs);
  // Threads along the length keep the stripes' edges crisp.
  finish.grainAspect = y > -0.004 && spacing < COARSE_WEAVE_M ? 2.4 : 1.3;
  finish.grainX = Math.sin(ASKEW);
  finish.grainZ = Math.cos(ASKEW);
  finish.sheen = 0.35;
  finish.roughness = 0.95;
  finish.twoSided = y < -0.02;
  finish.through.fill(y < -0.02 ? 0.25 : 0);
  // Valleys between folds are a little darker than their normals alone would make them.
  finish.cavity = y > 0 ? clamp01(0.86 + 14 * (y - THICKNESS_M)) * (0.75 + 0.25 * normalY) : 0.9;
}

/** Length of the fringe, which varies by a fifth. */
const FRINGE_LENGTH_M = 0.035;
const FRINGE_SEGMENTS = 2;

export const clothParts: readonly Part[] = [
  surfacePart({
    name: 'cloth',
    weight: 17_000,
    surface: new BentSheet(WIDTH_M, LENGTH_M, placeCloth),
    owner: 'cloth',
    finish: clothFinish,
  }),
  {
    name: 'fringe',
    weight: 900,
    emit: (count, studio) => {
      const threads = Math.ceil(count / FRINGE_SEGMENTS);
      const root = new Float64Array(3);
      emitFibres(count, studio, {
        segments: FRINGE_SEGMENTS,
        radius: 0.00045,
        color: LINEN,
        gloss: 0.02,
        opacity: [0.55, 0.95],
        owner: 'cloth',
        place: (thread, t, out) => {
          const a = WIDTH_M * ((thread + 0.5) / threads - 0.5);
          placeCloth(a, LENGTH_M / 2, root);
          const sway = 0.008 * (latticeHash(thread, 1, 7) - 0.5);
          out[0] = root[0] + sway * t;
          out[1] = root[1] - FRINGE_LENGTH_M * t * (0.8 + 0.4 * latticeHash(thread, 2, 7));
          out[2] = root[2] + 0.006 * (latticeHash(thread, 3, 7) - 0.5) * t;
        },
      });
    },
  },
];
