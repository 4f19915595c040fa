/**
 * Positions of all objects, shared by the visible surfaces and the stand-ins that shade them. Metres, y up, the
 * table's top at y = 0 with its middle at the origin; the usual camera looks along -z.
 */
import type { Rgb } from './lighting.ts';
import {
  bowlOccluder,
  capsuleOccluder,
  type Occluder,
  OcclusionField,
  sphereOccluder,
  turnedOccluder,
} from './occlusion.ts';
import { type Pose, pose } from './pose.ts';
import type { ReflectedBall } from './shading.ts';
import { type Profile, TurnedSurface } from './surface-sampling.ts';

type Point = readonly [x: number, y: number, z: number];

export const TABLE_RADIUS = 0.6;
/** The terrace that the table stands on. */
export const GROUND_Y = -0.74;

export const VASE: Point = [-0.2, 0, -0.12];
export const VASE_PROFILE: Profile = [
  [0, 0],
  [0.045, 0],
  [0.051, 0.006],
  [0.048, 0.015],
  [0.072, 0.05],
  [0.093, 0.1],
  [0.097, 0.14],
  [0.082, 0.19],
  [0.052, 0.228],
  [0.035, 0.255],
  [0.034, 0.275],
  [0.044, 0.295],
  [0.047, 0.3],
  [0.043, 0.301],
  [0.03, 0.28],
  [0.028, 0.25],
  [0.04, 0.225],
];

export const BOWL: Point = [0.2, 0, -0.04];
export const BOWL_PROFILE: Profile = [
  [0, 0.004],
  [0.046, 0],
  [0.052, 0.008],
  [0.058, 0.014],
  [0.092, 0.032],
  [0.126, 0.062],
  [0.147, 0.096],
  [0.1485, 0.101],
  [0.1455, 0.1015],
  [0.142, 0.095],
  [0.12, 0.063],
  [0.086, 0.036],
  [0.045, 0.02],
  [0, 0.016],
];
/** The sphere that the bowl's wall follows. */
const BOWL_SPHERE_RADIUS = 0.171;
const BOWL_SPHERE_Y = 0.183;
const BOWL_WALL_M = 0.008;
const BOWL_RIM_Y = 0.1;

export const BOTTLE: Point = [0.02, 0, -0.3];
export const BOTTLE_PROFILE: Profile = [
  [0, 0.003],
  [0.036, 0],
  [0.042, 0.006],
  [0.0425, 0.07],
  [0.042, 0.15],
  [0.038, 0.185],
  [0.021, 0.218],
  [0.0145, 0.242],
  [0.0135, 0.29],
  [0.0175, 0.293],
  [0.0175, 0.303],
  [0.012, 0.304],
];

export const BALL_RADIUS = 0.05;
export const BALL: Point = [-0.02, BALL_RADIUS, 0.17];

export const LOAF: Point = [-0.31, 0, 0.17];
export const LOAF_PROFILE: Profile = [
  [0, 0],
  [0.07, 0],
  [0.098, 0.014],
  [0.104, 0.034],
  [0.088, 0.062],
  [0.052, 0.082],
  [0, 0.089],
];

const ORANGE_RADIUS = 0.038;
export const ORANGE_PROFILE: Profile = [
  [0, -0.037],
  [0.0145, -0.0345],
  [0.0275, -0.026],
  [0.0355, -0.0135],
  [0.038, 0],
  [0.0355, 0.0135],
  [0.0275, 0.026],
  [0.0145, 0.034],
  [0.006, 0.0358],
  [0, 0.0338],
];
export const HALF_ORANGE_PROFILE: Profile = [
  [0, -0.037],
  [0.0145, -0.0345],
  [0.0275, -0.026],
  [0.0355, -0.0135],
  [0.0375, -0.006],
  [0.038, -0.0025],
  [0.0377, -0.0008],
  [0.0368, 0],
  [0.035, 0.0003],
  [0.03, 0.0004],
  [0.018, 0.0004],
  [0, 0.0004],
];
export const LEMON_PROFILE: Profile = [
  [0, -0.046],
  [0.006, -0.0445],
  [0.0105, -0.039],
  [0.021, -0.028],
  [0.028, -0.011],
  [0.0287, 0.006],
  [0.0225, 0.024],
  [0.0125, 0.036],
  [0.0075, 0.043],
  [0, 0.0475],
];
const LEMON_RADIUS = 0.027;
const LEMON_CORE_M = 0.02;
export const PEAR_PROFILE: Profile = [
  [0, 0.004],
  [0.01, 0.0005],
  [0.027, 0.005],
  [0.04, 0.024],
  [0.0415, 0.042],
  [0.035, 0.06],
  [0.025, 0.077],
  [0.0195, 0.091],
  [0.0135, 0.101],
  [0.005, 0.1035],
  [0, 0.101],
];

/** A posed copy of a fruit. */
interface Placement {
  readonly name: string;
  readonly pose: Pose;
}

export const ORANGES: readonly Placement[] = [
  { name: 'orange-left', pose: pose(0.137, 0.078, -0.01, 20, 25, 200) },
  { name: 'orange-front', pose: pose(0.228, 0.076, 0.022, 70, 35, 20) },
  { name: 'orange-back', pose: pose(0.238, 0.078, -0.09, 130, 20, 120) },
  { name: 'orange-top', pose: pose(0.187, 0.123, -0.045, 10, 40, 330) },
  { name: 'orange-table', pose: pose(0.118, ORANGE_RADIUS, 0.265, 45, 50, 30) },
];
export const HALF_ORANGE: Placement = {
  name: 'half-orange',
  pose: pose(0.235, 0.037, 0.245, 15, 62, -14),
};
export const LEMONS: readonly Placement[] = [
  { name: 'lemon-bowl', pose: pose(0.262, 0.112, -0.028, 0, 78, 50) },
  { name: 'lemon-back', pose: pose(0.15, 0.098, -0.105, 0, 70, 215) },
  { name: 'lemon-table', pose: pose(-0.105, 0.028, 0.335, 0, 88, 68) },
];
export const PEAR: Placement = { name: 'pear', pose: pose(0.395, -0.001, 0.13, 0, 7, 70) };

const CERAMIC_TINT: Rgb = [0.04, 0.16, 0.17];
const JADE_TINT: Rgb = [0.3, 0.5, 0.3];
const ORANGE_TINT: Rgb = [0.85, 0.28, 0.03];
const LEMON_TINT: Rgb = [0.85, 0.62, 0.06];
const PEAR_TINT: Rgb = [0.5, 0.5, 0.1];
const CRUST_TINT: Rgb = [0.42, 0.22, 0.09];
const STEEL_TINT: Rgb = [0.45, 0.45, 0.45];
/** Wood and the linen on it, averaged. */
export const TABLE_TINT: Rgb = [0.42, 0.27, 0.15];
const PLUME_TINT: Rgb = [0.6, 0.48, 0.34];

/** Base, direction and length of the plumes that stand in the vase. */
interface Plume {
  readonly base: Point;
  readonly direction: Point;
  /** How far the tip sags sideways and down, metres. */
  readonly sag: Point;
  readonly length: number;
}

const MOUTH_Y = 0.29;
function plume(azimuthDegrees: number, tiltDegrees: number, length: number, sag: number): Plume {
  const azimuth = (azimuthDegrees * Math.PI) / 180;
  const tilt = (tiltDegrees * Math.PI) / 180;
  const outX = Math.cos(azimuth);
  const outZ = Math.sin(azimuth);
  return {
    base: [VASE[0] + 0.02 * outX, MOUTH_Y - 0.04, VASE[2] + 0.02 * outZ],
    direction: [Math.sin(tilt) * outX, Math.cos(tilt), Math.sin(tilt) * outZ],
    sag: [sag * outX, -0.6 * sag, sag * outZ],
    length,
  };
}

export const PLUMES: readonly Plume[] = [
  plume(205, 17, 0.52, 0.1),
  plume(340, 13, 0.56, 0.1),
  plume(80, 8, 0.44, 0.07),
  plume(265, 6, 0.62, 0.06),
  plume(30, 24, 0.43, 0.12),
];

/** A point of a plume's stem, `t` from 0 at the vase to 1 at the tip. */
export function plumeStem({ base, direction, sag, length }: Plume, t: number, out: Float64Array): void {
  for (let k = 0; k < 3; k++) out[k] = base[k] + direction[k] * length * t + sag[k] * t * t;
}

/** Share of a plume's stem, from the vase up, that is bare. */
export const PLUME_BARE = 0.42;

/** Objects' footprints on the table, for contact shadows and for the cloth to lie flat under. */
interface Footprint {
  readonly x: number;
  readonly z: number;
  readonly radius: number;
}

export const FOOTPRINTS: readonly Footprint[] = [
  { x: VASE[0], z: VASE[2], radius: 0.05 },
  { x: BOWL[0], z: BOWL[2], radius: 0.055 },
  { x: BOTTLE[0], z: BOTTLE[2], radius: 0.042 },
  { x: BALL[0], z: BALL[2], radius: 0.018 },
  { x: LOAF[0], z: LOAF[2], radius: 0.085 },
  { x: 0.118, z: 0.265, radius: 0.018 },
  { x: 0.235, z: 0.245, radius: 0.02 },
  { x: -0.105, z: 0.335, radius: 0.024 },
  { x: 0.395, z: 0.13, radius: 0.025 },
];

const SILHOUETTE_STEPS = 48;

function turned(owner: string, [x, y, z]: Point, profile: Profile, tint: Rgb): Occluder {
  const { bottomY, topY, radii } = new TurnedSurface(profile).silhouette(SILHOUETTE_STEPS);
  return turnedOccluder(owner, x, z, y + bottomY, y + topY, radii, tint);
}

function plumeOccluder(stem: Plume): Occluder {
  const low = new Float64Array(3);
  const high = new Float64Array(3);
  plumeStem(stem, PLUME_BARE + 0.15, low);
  plumeStem(stem, 0.93, high);
  // Thinner than it looks: light filters through the outer strands.
  return capsuleOccluder('plumes', [low[0], low[1], low[2]], [high[0], high[1], high[2]], 0.014, PLUME_TINT);
}

/** A lemon's core line, along its own y axis. */
function lemonOccluder({ name, pose: { rotation: m, translation: t } }: Placement): Occluder {
  const end = (sign: number): Point => [
    t[0] + sign * LEMON_CORE_M * m[1],
    t[1] + sign * LEMON_CORE_M * m[4],
    t[2] + sign * LEMON_CORE_M * m[7],
  ];
  return capsuleOccluder(name, end(-1), end(1), LEMON_RADIUS * 0.9, LEMON_TINT);
}

/** The stand-ins of all objects. */
export function makeOcclusionField(): OcclusionField {
  const tableTop = new Float64Array([TABLE_RADIUS - 0.01, TABLE_RADIUS, TABLE_RADIUS]);
  const pedestal = new Float64Array([0.27, 0.1, 0.055, 0.05, 0.05, 0.07, 0.2]);
  const [pearX, , pearZ] = PEAR.pose.translation;
  const [halfX, halfY, halfZ] = HALF_ORANGE.pose.translation;
  return new OcclusionField([
    turnedOccluder('table', 0, 0, -0.04, 0, tableTop, TABLE_TINT),
    turnedOccluder('table', 0, 0, GROUND_Y, -0.05, pedestal, TABLE_TINT),
    turned('vase', VASE, VASE_PROFILE, CERAMIC_TINT),
    bowlOccluder(
      'bowl',
      [BOWL[0], BOWL_SPHERE_Y, BOWL[2]],
      BOWL_SPHERE_RADIUS,
      BOWL_WALL_M,
      BOWL_RIM_Y,
      JADE_TINT,
    ),
    sphereOccluder('ball', BALL[0], BALL[1], BALL[2], BALL_RADIUS, STEEL_TINT),
    turned('loaf', LOAF, LOAF_PROFILE, CRUST_TINT),
    ...ORANGES.map(({ name, pose: { translation: t } }) =>
      sphereOccluder(name, t[0], t[1], t[2], ORANGE_RADIUS * 0.97, ORANGE_TINT),
    ),
    sphereOccluder('half-orange', halfX, halfY - 0.008, halfZ - 0.012, 0.024, ORANGE_TINT),
    ...LEMONS.map(lemonOccluder),
    sphereOccluder('pear', pearX, 0.04, pearZ, 0.04, PEAR_TINT),
    sphereOccluder('pear', pearX + 0.007, 0.084, pearZ, 0.021, PEAR_TINT),
    ...PLUMES.map(plumeOccluder),
  ]);
}

/** Neighbours large and bright enough to show in a polished surface. */
export const REFLECTED_BALLS: readonly ReflectedBall[] = [
  { owner: 'loaf', center: [LOAF[0], 0.045, LOAF[2]], radius: 0.09, color: CRUST_TINT },
  { owner: 'bowl', center: [BOWL[0], 0.06, BOWL[2]], radius: 0.11, color: JADE_TINT },
  { owner: 'orange-top', center: [0.187, 0.11, -0.04], radius: 0.07, color: ORANGE_TINT },
  { owner: 'orange-table', center: [0.118, ORANGE_RADIUS, 0.265], radius: ORANGE_RADIUS, color: ORANGE_TINT },
  { owner: 'lemon-table', center: [-0.105, 0.028, 0.335], radius: 0.034, color: LEMON_TINT },
  { owner: 'vase', center: [VASE[0], 0.13, VASE[2]], radius: 0.1, color: CERAMIC_TINT },
  { owner: 'ball', center: BALL, radius: BALL_RADIUS, color: STEEL_TINT },
];
