/** The table and what is made by hand: glazed vase, jade bowl, glass bottle, steel ball, loaf. */
import {
  BALL,
  BALL_RADIUS,
  BOTTLE,
  BOTTLE_PROFILE,
  BOWL,
  BOWL_PROFILE,
  GROUND_Y,
  LOAF,
  LOAF_PROFILE,
  VASE,
  VASE_PROFILE,
} from './arrangement.ts';
import { clothInset, LINEN } from './cloth.ts';
import { emitFibres } from './fibres.ts';
import { clamp01, fractalNoise, latticeHash, mix, smoothstep, valueNoise } from './noise.ts';
import { type Part, type Studio, surfacePart } from './part.ts';
import { pose } from './pose.ts';
import type { Finish } from './shading.ts';
import {
  apportion,
  DiscSurface,
  type Profile,
  type SurfacePoint,
  TurnedSurface,
} from './surface-sampling.ts';

/** Mirror reflectance at normal incidence of glaze, varnish, glass and skins: a refractive index of 1.5. */
const DIELECTRIC = 0.04;

const PLANK_WIDTH_M = 0.118;
/** Boards end this far from the line between them; splats that draw the line fill the rest. */
const PLANK_GAP_M = 0.0035;
const WOOD_LIGHT = [0.4, 0.215, 0.098] as const;
const WOOD_DARK = [0.17, 0.078, 0.034] as const;

function woodFinish(along: number, across: number, finish: Finish): void {
  const plank = Math.floor(across / PLANK_WIDTH_M);
  const tone = latticeHash(plank, 5, 0);
  const shift = 7 * tone;
  const warp = 0.012 * valueNoise(along * 3 + shift, across * 9, plank);
  // Broad early-wood bands that meander, and fine pores drawn out along the plank.
  const bands = 0.5 + 0.5 * Math.sin((across + warp) * 330 + 2 * valueNoise(along * 2.2, across * 20, shift));
  const pores = fractalNoise(along * 9 + shift, across * 260, plank, 2);
  finish.mixAlbedo(WOOD_LIGHT, WOOD_DARK, clamp01(0.22 + 0.3 * bands * (0.5 + 0.5 * tone) + 0.3 * pores));
  finish.scaleAlbedo(0.8 + 0.4 * tone);
  finish.setMirror(DIELECTRIC);
  finish.roughness = 0.4;
}

/**
 * The table's top, its splats kept clear of the lines between planks: a splat of a board that reaches across would
 * cut a line into dashes.
 */
class PlankedDisc extends DiscSurface {
  override sample(u: number, v: number, point: SurfacePoint): number {
    const area = super.sample(u, v, point);
    const middle = (Math.floor(point.z / PLANK_WIDTH_M) + 0.5) * PLANK_WIDTH_M;
    point.z = middle + (point.z - middle) * (1 - (2 * PLANK_GAP_M) / PLANK_WIDTH_M);
    if (clothInset(point.x, point.z) > 0.004) point.y -= UNDER_CLOTH_M;
    return area;
  }
}

const WOOD_ASPECT = 3.4;

/** Less stretch towards the ends of the boards, so that no splat reaches out over the table's edge. */
function grainInsideEdge({ x, z, spacing }: SurfacePoint): number {
  const toEnd = Math.sqrt(Math.max(0, TOP_RADIUS_M ** 2 - z * z)) - Math.abs(x);
  return Math.max(1, Math.min(WOOD_ASPECT, ((0.8 * toEnd) / spacing) ** 2));
}

/** Wood under the runner lies lower than it would: sorted by its centre, a splat of it could show above the linen. */
const UNDER_CLOTH_M = 0.006;

const TOP_RADIUS_M = 0.59;
/** Just above the boards, whose splats would otherwise win half of the draws. */
const GAP_HEIGHT_M = 0.0004;
const GAP_COLOR = [0.035, 0.017, 0.009] as const;

const PLANKS_PER_SIDE = Math.ceil(TOP_RADIUS_M / PLANK_WIDTH_M);

/** A straight stretch of a line between planks. */
interface GapStretch {
  readonly z: number;
  readonly fromX: number;
  readonly toX: number;
}

/** The lines between planks as far as they are seen: inside the table's edge and not under the runner. */
function gapStretches(): GapStretch[] {
  const stretches: GapStretch[] = [];
  const stepM = 0.002;
  for (let line = -PLANKS_PER_SIDE; line <= PLANKS_PER_SIDE; line++) {
    const z = line * PLANK_WIDTH_M;
    // A line that would only graze the edge is left out.
    if (Math.abs(z) > TOP_RADIUS_M - 0.25 * PLANK_WIDTH_M) continue;
    const end = Math.sqrt(TOP_RADIUS_M ** 2 - z * z);
    let start: number | undefined;
    for (let x = -end; x <= end + stepM; x += stepM) {
      const seen = x <= end && clothInset(x, z) < 0;
      if (seen) start ??= x;
      else if (start !== undefined) {
        stretches.push({ z, fromX: start, toX: x - stepM });
        start = undefined;
      }
    }
  }
  return stretches.filter(({ fromX, toX }) => toX - fromX > 10 * stepM);
}

const GAP_STRETCHES = gapStretches();

/** Dark needles end to end along every stretch. */
function emitGaps(count: number, studio: Studio): void {
  const lengths = GAP_STRETCHES.map(({ fromX, toX }) => toX - fromX);
  const shares = apportion(count, lengths, 0);
  GAP_STRETCHES.forEach(({ z, fromX, toX }, index) => {
    const segments = shares[index];
    // Ends are drawn in by the length that a splat reaches beyond its stretch.
    const inset = (0.5 * (toX - fromX)) / (segments + 1);
    emitFibres(segments, studio, {
      segments,
      radius: 0.0013,
      widens: false,
      color: GAP_COLOR,
      gloss: 0,
      opacity: [0.75, 0.95],
      owner: 'table',
      place: (_, t, out) => {
        out[0] = mix(fromX + inset, toX - inset, t);
        out[1] = GAP_HEIGHT_M;
        out[2] = z;
      },
    });
  });
}

const TABLE_UNDERSIDE_PROFILE: Profile = [
  [0.264, GROUND_Y],
  [0.27, GROUND_Y + 0.01],
  [0.26, GROUND_Y + 0.024],
  [0.18, GROUND_Y + 0.045],
  [0.075, GROUND_Y + 0.09],
  [0.05, GROUND_Y + 0.16],
  [0.062, GROUND_Y + 0.25],
  [0.045, GROUND_Y + 0.36],
  [0.042, -0.24],
  [0.06, -0.14],
  [0.13, -0.075],
  [0.26, -0.048],
  [0.52, -0.043],
  [0.57, -0.04],
];

const TABLE_RIM_PROFILE: Profile = [
  [0.58, -0.039],
  [0.595, -0.036],
  [0.6, -0.028],
  [0.601, -0.018],
  [0.599, -0.006],
  [0.594, -0.001],
  [0.584, 0],
];

const GLAZE = [0.028, 0.17, 0.19] as const;
const GLAZE_POOL = [0.012, 0.075, 0.105] as const;
const GLAZE_BREAK = [0.3, 0.36, 0.27] as const;
const STONEWARE = [0.36, 0.2, 0.12] as const;

function vaseFinish(
  { spacing, x, z, localX, localY, localZ, normalX, normalZ }: SurfacePoint,
  finish: Finish,
): void {
  const angle = Math.atan2(localZ, localX);
  const runs = 0.014 * valueNoise(Math.cos(angle) * 3, Math.sin(angle) * 3, 2) + 0.006 * Math.sin(angle * 9);
  const glazed = smoothstep(0.046 + runs, 0.05 + runs, localY);
  const inside = localX * normalX + localZ * normalZ < -0.005 * Math.hypot(localX, localZ) ? 1 : 0;
  // Glaze runs thin over the shoulder and pools at its lower edge.
  const pooled = 1 - smoothstep(0.05 + runs, 0.085 + runs, localY);
  const mottle = fractalNoise(localX * 38, localY * 26, localZ * 38, 2);
  finish.mixAlbedo(GLAZE, GLAZE_POOL, Math.min(1, 0.75 * pooled + 0.5 * Math.max(0, mottle)));
  const rim =
    smoothstep(0.288, 0.3, localY) + 0.5 * smoothstep(0.19, 0.228, localY) * Math.max(0, mottle + 0.3);
  finish.blendAlbedo(GLAZE_BREAK, Math.min(0.85, 0.7 * rim));
  finish.blendAlbedo(STONEWARE, 1 - glazed);
  const grit = fractalNoise(localX * 300, localY * 300, localZ * 300, 2);
  finish.scaleAlbedo(1 + (1 - glazed) * 0.4 * grit);
  finish.setMirror(mix(0.0, 0.065, glazed));
  finish.roughness = mix(0.8, 0.06, glazed);
  if (inside && localY > 0.2) finish.cavity = mix(0.08, 0.8, smoothstep(0.24, 0.3, localY));
  finish.opacityLow = 0.9;
  if (localY > 0.285) grainAround(x - VASE[0], z - VASE[2], spacing, finish);
}

/** Draws splats out around a rim: across it they would stand out from its narrow curve like bristles. */
function grainAround(fromAxisX: number, fromAxisZ: number, spacing: number, finish: Finish): void {
  // Straight splats must stay short of the circle's own curve.
  const longest = (0.75 * Math.hypot(fromAxisX, fromAxisZ)) / spacing;
  finish.grainAspect = Math.max(1, Math.min(4, longest * longest));
  finish.grainX = -fromAxisZ;
  finish.grainZ = fromAxisX;
}

const JADE = [0.42, 0.62, 0.4] as const;
const JADE_VEIN = [0.16, 0.36, 0.22] as const;
const JADE_CLOUD = [0.72, 0.78, 0.6] as const;

function bowlFinish({ spacing, x, z, localX, localY, localZ }: SurfacePoint, finish: Finish): void {
  const veins = Math.abs(fractalNoise(localX * 14 + 3, localY * 14, localZ * 14, 3));
  const clouds = fractalNoise(localX * 9, localY * 22 + 5, localZ * 9, 2);
  finish.mixAlbedo(JADE, JADE_CLOUD, Math.max(0, 1.2 * clouds));
  finish.blendAlbedo(JADE_VEIN, 0.85 * (1 - smoothstep(0.0, 0.12, veins)));
  finish.setMirror(0.05);
  finish.roughness = 0.12;
  finish.scatter.set([0.55, 0.65, 0.5]);
  finish.through.set([0.3, 0.42, 0.24]);
  finish.twoSided = true;
  if (localY > 0.09) grainAround(x - BOWL[0], z - BOWL[2], spacing, finish);
  // Stone that light enters: the wall is two veils, denser at the thick foot.
  const foot = 1 - smoothstep(0.012, 0.045, localY);
  finish.opacityLow = mix(0.4, 0.85, foot);
  finish.opacityHigh = mix(0.6, 0.97, foot);
}

const GLASS = [0.05, 0.11, 0.045] as const;

function bottleFinish({ spacing, x, z, localY }: SurfacePoint, finish: Finish): void {
  finish.setAlbedo(GLASS);
  // More than glass has, so that it shows in the faint splats.
  finish.setMirror(DIELECTRIC * 3);
  finish.roughness = 0.05;
  finish.through.set([0.5, 0.9, 0.35]);
  finish.twoSided = true;
  if (localY > 0.28) grainAround(x - BOTTLE[0], z - BOTTLE[2], spacing, finish);
  const thick = 1 - smoothstep(0.004, 0.018, localY) + smoothstep(0.284, 0.292, localY);
  finish.opacityLow = mix(0.09, 0.35, thick);
  finish.opacityHigh = mix(0.16, 0.65, thick);
}

const STEEL = [0.9, 0.88, 0.84] as const;

function ballFinish({ localX, localY, localZ }: SurfacePoint, finish: Finish): void {
  finish.mirror.set(STEEL);
  const tarnish = smoothstep(0.1, 0.5, fractalNoise(localX * 50, localY * 50, localZ * 50, 3));
  for (let k = 0; k < 3; k++) finish.mirror[k] *= 1 - 0.12 * tarnish;
  finish.roughness = 0.03 + 0.08 * tarnish;
  finish.opacityLow = 0.93;
}

function ballProfile(radius: number): Profile {
  const points = 9;
  return Array.from({ length: points }, (_, i) => {
    const angle = Math.PI * (i / (points - 1) - 0.5);
    return [Math.max(0, radius * Math.cos(angle)), radius * Math.sin(angle)] as const;
  });
}

const CRUST = [0.4, 0.19, 0.07] as const;
const CRUST_DARK = [0.17, 0.068, 0.025] as const;
const CRUMB = [0.74, 0.55, 0.33] as const;
const FLOUR = [0.85, 0.8, 0.7] as const;

/** Depth below the crust's surface of the baker's two crossed cuts, 0 to 1. */
function loafCut(x: number, y: number, z: number): number {
  if (y < 0.03) return 0;
  const wobble = 0.004 * valueNoise(x * 40, 3, z * 40);
  const u = 0.8 * x + 0.6 * z;
  const v = -0.6 * x + 0.8 * z;
  const cut = (across: number, along: number) =>
    (1 - smoothstep(0.006, 0.013, Math.abs(across + wobble))) *
    (1 - smoothstep(0.06, 0.082, Math.abs(along)));
  return Math.max(cut(u, v), cut(v, u)) * smoothstep(0.03, 0.05, y);
}

function loafRelief(x: number, y: number, z: number): number {
  const rise = 0.004 * fractalNoise(x * 26, y * 26, z * 26, 2);
  const crackle = 0.0022 * fractalNoise(x * 130, y * 130, z * 130, 2);
  return rise + crackle - 0.008 * loafCut(x, y, z);
}

function loafFinish({ localX: x, localY: y, localZ: z }: SurfacePoint, finish: Finish): void {
  const blotch = fractalNoise(x * 30 + 9, y * 30, z * 30, 3);
  finish.mixAlbedo(CRUST, CRUST_DARK, smoothstep(-0.3, 0.5, blotch));
  const cut = loafCut(x, y, z);
  finish.blendAlbedo(CRUMB, 0.85 * cut);
  const dust = fractalNoise(x * 160, y * 160, z * 160, 2) + 0.6 * fractalNoise(x * 18, 4, z * 18, 2);
  finish.blendAlbedo(FLOUR, 0.75 * smoothstep(0.02, 0.4, dust) * smoothstep(0.03, 0.07, y) * (1 - cut));
  finish.blendAlbedo(CRUST_DARK, 0.5 * (1 - smoothstep(0.002, 0.02, y)));
  finish.scatter.set([0.25, 0.15, 0.08]);
  finish.cavity =
    0.8 + 0.2 * smoothstep(-0.4, 0.3, fractalNoise(x * 130, y * 130, z * 130, 2)) - 0.25 * cut * (1 - cut);
  finish.sheen = 0.25;
  finish.roughness = 0.9;
}

export const tablewareParts: readonly Part[] = [
  surfacePart({
    name: 'table-top',
    weight: 27_000,
    surface: new PlankedDisc(TOP_RADIUS_M),
    owner: 'table',
    finish: (point, finish) => {
      woodFinish(point.x, point.z, finish);
      // Wood under the runner takes the linen's colour, as little of it as may shine through.
      if (clothInset(point.x, point.z) > 0.004) finish.setAlbedo(LINEN);
      finish.grainAspect = grainInsideEdge(point);
      finish.opacityLow = 0.86;
    },
  }),
  {
    name: 'plank-gaps',
    weight: 900,
    emit: emitGaps,
  },
  surfacePart({
    name: 'table-underside',
    weight: 5_000,
    surface: new TurnedSurface(TABLE_UNDERSIDE_PROFILE),
    owner: 'table',
    finish: ({ x, y, z }, finish) => {
      const angle = Math.atan2(z, x);
      woodFinish(y < -0.05 ? y : x, y < -0.05 ? 0.06 * angle : z, finish);
      finish.scaleAlbedo(0.85);
      // Splats along the foot's edge, not across it.
      if (y < GROUND_Y + 0.03) {
        finish.grainAspect = 2.5;
        finish.grainX = -z;
        finish.grainZ = x;
      }
      // Under the top it is darker than marching over a few decimetres can find.
      finish.cavity *= 1 - 0.6 * smoothstep(-0.5, -0.05, y);
    },
  }),
  surfacePart({
    name: 'table-rim',
    weight: 5_500,
    surface: new TurnedSurface(TABLE_RIM_PROFILE),
    owner: 'table',
    finish: ({ x, y, z }, finish) => {
      woodFinish(x + 0.4 * y, z, finish);
      if (clothInset(x, z) > 0.01) finish.setAlbedo(LINEN);
      finish.grainAspect = 3;
      finish.grainX = -z;
      finish.grainZ = x;
      finish.cavity *= mix(0.55, 1, smoothstep(-0.04, -0.02, y));
    },
  }),
  surfacePart({
    name: 'vase',
    weight: 14_000,
    surface: new TurnedSurface(VASE_PROFILE),
    pose: pose(VASE[0], VASE[1], VASE[2], 35),
    owner: 'vase',
    finish: vaseFinish,
  }),
  surfacePart({
    name: 'bowl',
    weight: 13_000,
    surface: new TurnedSurface(BOWL_PROFILE),
    pose: pose(BOWL[0], BOWL[1], BOWL[2]),
    owner: 'bowl',
    coverage: 0.72,
    faintShare: 0,
    finish: bowlFinish,
  }),
  surfacePart({
    name: 'bottle',
    weight: 5_000,
    surface: new TurnedSurface(BOTTLE_PROFILE),
    pose: pose(BOTTLE[0], BOTTLE[1], BOTTLE[2]),
    owner: 'bottle',
    coverage: 0.85,
    faintShare: 0,
    finish: bottleFinish,
  }),
  surfacePart({
    name: 'ball',
    weight: 5_500,
    surface: new TurnedSurface(ballProfile(BALL_RADIUS)),
    pose: pose(BALL[0], BALL[1], BALL[2]),
    owner: 'ball',
    finish: ballFinish,
  }),
  surfacePart({
    name: 'loaf',
    weight: 9_000,
    surface: new TurnedSurface(LOAF_PROFILE),
    pose: pose(LOAF[0], LOAF[1], LOAF[2], 25),
    owner: 'loaf',
    relief: loafRelief,
    finish: loafFinish,
  }),
];
