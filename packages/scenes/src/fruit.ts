/** Oranges whole and cut, lemons and a pear: dimpled skins that light scatters under. */
import {
  HALF_ORANGE,
  HALF_ORANGE_PROFILE,
  LEMON_PROFILE,
  LEMONS,
  ORANGE_PROFILE,
  ORANGES,
  PEAR,
  PEAR_PROFILE,
} from './arrangement.ts';
import { clamp01, fractalNoise, latticeHash, mix, smoothstep, valueNoise } from './noise.ts';
import { type Part, surfacePart } from './part.ts';
import type { Finish } from './shading.ts';
import { type SurfacePoint, TurnedSurface } from './surface-sampling.ts';

const SKIN_MIRROR = 0.045;

const ORANGE_SKIN = [0.92, 0.27, 0.018] as const;
const ORANGE_SKIN_DEEP = [0.78, 0.16, 0.01] as const;
const STEM_SCAR = [0.25, 0.24, 0.07] as const;
const PITH = [0.92, 0.8, 0.55] as const;
const FLESH = [0.95, 0.33, 0.025] as const;
const FLESH_DEEP = [0.8, 0.17, 0.008] as const;

/** Dimples about 2 mm apart, as depth in metres, below zero. */
function dimples(x: number, y: number, z: number, depth: number): number {
  const noise = valueNoise(x * 420, y * 420, z * 420);
  return -depth * smoothstep(0.1, 0.75, noise);
}

function orangeSkin({ localX: x, localY: y, localZ: z }: SurfacePoint, finish: Finish): void {
  const patches = fractalNoise(x * 40, y * 40, z * 40, 2);
  finish.mixAlbedo(ORANGE_SKIN, ORANGE_SKIN_DEEP, 0.55 * smoothstep(-0.5, 0.6, patches));
  finish.scaleAlbedo(1 + dimples(x, y, z, 0.22));
  finish.blendAlbedo(STEM_SCAR, 1 - smoothstep(0.003, 0.0055, Math.hypot(x, z) + (y < 0 ? 1 : 0)));
  finish.setMirror(SKIN_MIRROR);
  finish.roughness = 0.3;
  finish.scatter.set([0.38, 0.2, 0.06]);
}

const SEGMENTS = 10;

function halfOrangeFinish(point: SurfacePoint, finish: Finish): void {
  const { localX: x, localY: y, localZ: z, spacing } = point;
  if (y < -0.0012) {
    orangeSkin(point, finish);
    return;
  }
  const radius = Math.hypot(x, z);
  const turn = (Math.atan2(z, x) / (2 * Math.PI)) * SEGMENTS + 0.08 * valueNoise(x * 90, 1, z * 90);
  const fromWall = Math.abs(turn - Math.round(turn)) * ((2 * Math.PI * radius) / SEGMENTS);
  const segment = latticeHash(Math.floor(turn + 0.5), 3, 3);
  // Juice sacs are drops that point at the middle.
  const sacs = valueNoise(x * 160 + 40 * segment, 2, z * 160) + 0.6 * valueNoise(x * 420, 5, z * 420);
  finish.mixAlbedo(FLESH, FLESH_DEEP, smoothstep(-0.6, 0.8, sacs) * 0.75 + 0.2 * segment);
  // Walls are drawn as far as splats are fine enough for them.
  const wall = (1 - smoothstep(0.0005, 0.0013, fromWall)) * clamp01((0.003 / spacing) ** 2);
  const rind = smoothstep(0.0325, 0.0335, radius) * clamp01(0.005 / spacing);
  const core = 1 - smoothstep(0.0025, 0.0045, radius);
  finish.blendAlbedo(PITH, Math.max(0.8 * wall, rind, core));
  finish.blendAlbedo(ORANGE_SKIN, smoothstep(0.0362, 0.037, radius));
  finish.setMirror(SKIN_MIRROR * (1 - rind));
  finish.roughness = mix(0.22, 0.7, rind);
  finish.scatter.set([0.5, 0.35, 0.15]);
  finish.cavity = 0.94;
}

const LEMON_SKIN = [0.9, 0.66, 0.035] as const;
const LEMON_SKIN_GREEN = [0.62, 0.62, 0.05] as const;

function lemonSkin({ localX: x, localY: y, localZ: z }: SurfacePoint, finish: Finish): void {
  finish.mixAlbedo(
    LEMON_SKIN,
    LEMON_SKIN_GREEN,
    0.8 * smoothstep(0.028, 0.047, Math.abs(y)) + 0.25 * Math.max(0, fractalNoise(x * 30, y * 30, z * 30, 2)),
  );
  finish.scaleAlbedo(1 + dimples(x, y, z, 0.12));
  finish.setMirror(SKIN_MIRROR);
  finish.roughness = 0.26;
  finish.scatter.set([0.35, 0.28, 0.08]);
}

const PEAR_SKIN = [0.56, 0.52, 0.09] as const;
const PEAR_BLUSH = [0.62, 0.17, 0.055] as const;
const RUSSET = [0.3, 0.2, 0.07] as const;

function pearSkin({ localX: x, localY: y, localZ: z, normalX }: SurfacePoint, finish: Finish): void {
  const patches = fractalNoise(x * 45, y * 45, z * 45, 3);
  finish.mixAlbedo(PEAR_SKIN, PEAR_BLUSH, smoothstep(-0.5, 0.7, 0.8 * normalX + 0.5 * patches));
  const freckles = smoothstep(0.45, 0.7, valueNoise(x * 520, y * 520, z * 520));
  finish.blendAlbedo(RUSSET, 0.55 * freckles + 0.8 * smoothstep(0.094, 0.103, y));
  finish.setMirror(SKIN_MIRROR);
  finish.roughness = 0.3;
  finish.scatter.set([0.3, 0.24, 0.1]);
}

const ORANGE_SPLATS = 2_700;
const LEMON_SPLATS = 2_600;

export const fruitParts: readonly Part[] = [
  ...ORANGES.map(({ name, pose }) =>
    surfacePart({
      name,
      weight: ORANGE_SPLATS,
      surface: new TurnedSurface(ORANGE_PROFILE),
      pose,
      owner: name,
      relief: (x, y, z) => dimples(x, y, z, 0.00022) + 0.0006 * valueNoise(x * 45, y * 45, z * 45),
      finish: orangeSkin,
    }),
  ),
  surfacePart({
    name: HALF_ORANGE.name,
    weight: 4_000,
    surface: new TurnedSurface(HALF_ORANGE_PROFILE),
    pose: HALF_ORANGE.pose,
    owner: HALF_ORANGE.name,
    finish: halfOrangeFinish,
  }),
  ...LEMONS.map(({ name, pose }) =>
    surfacePart({
      name,
      weight: LEMON_SPLATS,
      surface: new TurnedSurface(LEMON_PROFILE),
      pose,
      owner: name,
      relief: (x, y, z) => dimples(x, y, z, 0.00018) + 0.0012 * valueNoise(x * 50, y * 30, z * 50),
      finish: lemonSkin,
    }),
  ),
  surfacePart({
    name: PEAR.name,
    weight: 3_400,
    surface: new TurnedSurface(PEAR_PROFILE),
    pose: PEAR.pose,
    owner: PEAR.name,
    relief: (x, y, z) => 0.0014 * valueNoise(x * 40, y * 40, z * 40),
    finish: pearSkin,
  }),
];
