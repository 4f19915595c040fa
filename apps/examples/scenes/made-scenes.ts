import { encodePly, type Vec3 } from '@websplatter/core';
import { birdFrames } from './bird.ts';
import { columnGlb } from './column.ts';
import { figurePly, figuresPly } from './figures.ts';
import { ringPly } from './ring.ts';
import { GOLDEN_RATIO, hash, splatsOf, wheel } from './splats.ts';

// Not in functions: these import further modules, which only load while this module is imported.
const column = await columnGlb();
const bird = await birdFrames();

/** Generated scenes, by file name. */
const MADE: Readonly<Record<string, () => Uint8Array>> = {
  'ring.ply': ringPly,
  'column.glb': () => column,
  'bird.frames': () => bird,
  'knot.ply': knotPly,
  'terrain.ply': terrainPly,
  'meadow.ply': meadowPly,
  'figure.ply': figurePly,
  'figures.ply': figuresPly,
};

/** @param frames number of files in the sequence `wave-0.ply` and so on. */
export function madeScene(name: string, frames: number): Uint8Array {
  const [, frame] = /^wave-(\d+)\.ply$/.exec(name) ?? [];
  return frame === undefined ? MADE[name]() : wavePly(Number(frame) / frames);
}

const KNOT_SPLATS = 16_000;
const TUBE_RADIUS = 0.1;

/** A trefoil knot of small splats, lit from above, coloured once around the wheel. */
function knotPly(): Uint8Array {
  const splats = splatsOf(KNOT_SPLATS, (i) => {
    const angle = (2 * Math.PI * i) / KNOT_SPLATS;
    const aroundTube = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const [here, next] = [trefoil(angle), trefoil(angle + 1e-3)];
    const along = unit([next[0] - here[0], next[1] - here[1], next[2] - here[2]]);
    const side = unit(cross(along, [0, 0, 1]));
    const up = cross(side, along);
    const [cosine, sine] = [Math.cos(aroundTube), Math.sin(aroundTube)];
    const out = [0, 1, 2].map((axis) => cosine * side[axis] + sine * up[axis]);
    const light = 0.62 + 0.38 * (0.75 * out[1] + 0.6 * out[2]);
    // Stripes around the tube show how it winds.
    const stripe = Math.cos(3 * aroundTube + 20 * angle) > 0.55 ? 1.25 : 1;
    return {
      position: here.map((each, axis) => each + TUBE_RADIUS * out[axis]),
      scale: [0.012, 0.003, 0.012],
      axis: out,
      color: wheel(i / KNOT_SPLATS, 0.5, 0.42).map((value) => value * light * stripe),
    };
  });
  return encodePly(splats);
}

const trefoil = (angle: number): Vec3 => [
  0.165 * (Math.sin(angle) + 2 * Math.sin(2 * angle)),
  0.165 * (Math.cos(angle) - 2 * Math.cos(2 * angle)),
  -0.165 * Math.sin(3 * angle),
];

const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

function unit([x, y, z]: Vec3): Vec3 {
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

const TERRAIN_SIDE = 140;
const TERRAIN_WIDTH = 1.7;
const SEA_HEIGHT = -0.03;

/** An island of hills with snow on top and the sea around, lit from the left. */
function terrainPly(): Uint8Array {
  const splats = splatsOf(TERRAIN_SIDE ** 2, (i) => {
    const at = (index: number, seed: number) =>
      ((index + hash(i, seed)) / TERRAIN_SIDE - 0.5) * TERRAIN_WIDTH;
    const [x, z] = [at(i % TERRAIN_SIDE, 1), at(Math.floor(i / TERRAIN_SIDE), 2)];
    const ground = terrainHeight(x, z);
    const isSea = ground < SEA_HEIGHT;
    const step = 0.004;
    const axis = isSea
      ? [0, 1, 0]
      : [(ground - terrainHeight(x + step, z)) / step, 1, (ground - terrainHeight(x, z + step)) / step];
    const light = Math.max(0.25, (axis[1] - 0.7 * axis[0]) / Math.hypot(...axis) / 1.22);
    const shade = (isSea ? 0.95 : light) * (0.92 + 0.16 * hash(i, 3));
    return {
      position: [x, Math.max(ground, SEA_HEIGHT), z],
      scale: [0.011, 0.003, 0.011],
      axis,
      color: terrainColor(ground).map((value) => value * shade),
      // The sea fades out towards its edge.
      opacityLogit: isSea ? 12 * (0.8 - Math.hypot(x, z)) : 3,
    };
  });
  return encodePly(splats);
}

function terrainHeight(x: number, z: number): number {
  const ridges =
    0.16 * Math.sin(4.1 * x + 1.3) * Math.cos(3.7 * z - 0.4) +
    0.07 * Math.sin(9.3 * x - 2.1 * z) +
    0.035 * Math.cos(17 * z + 6 * x) +
    0.014 * Math.sin(39 * x + 23 * z);
  return 0.32 * Math.exp(-3.4 * (x * x + z * z)) + ridges - 0.42 * (x * x + z * z);
}

function terrainColor(ground: number): number[] {
  if (ground < SEA_HEIGHT - 0.06) return [0.13, 0.36, 0.62];
  if (ground < SEA_HEIGHT) return [0.2, 0.6, 0.72];
  if (ground < 0.01) return [0.93, 0.84, 0.6];
  if (ground < 0.17) return [0.38, 0.6, 0.26];
  if (ground < 0.3) return [0.58, 0.5, 0.42];
  return [0.99, 0.99, 1];
}

const PLANTS = 260;
const STALK_SPLATS = 14;
const HEAD_SPLATS = 22;
const PLANT_SPLATS = STALK_SPLATS + HEAD_SPLATS;
const HEADS: readonly (readonly number[])[] = [
  [0.93, 0.22, 0.16],
  [0.98, 0.76, 0.2],
  [0.45, 0.42, 0.9],
  [0.97, 0.96, 0.93],
];

/** Flowers of four colours on thin stalks, in a round bed. */
function meadowPly(): Uint8Array {
  const splats = splatsOf(PLANTS * PLANT_SPLATS, (i) => {
    const [plant, part] = [Math.floor(i / PLANT_SPLATS), i % PLANT_SPLATS];
    const angle = 2 * Math.PI * ((plant * GOLDEN_RATIO) % 1);
    const distance = 0.72 * Math.sqrt((plant + 0.5) / PLANTS);
    const [x, z] = [distance * Math.cos(angle), distance * Math.sin(angle)];
    const top = 0.05 + 0.35 * hash(plant);
    const foot = -0.4;
    if (part < STALK_SPLATS) {
      const share = part / STALK_SPLATS;
      const light = 0.45 + 0.55 * share;
      return {
        position: [x + 0.02 * (hash(plant, 4) - 0.5) * share, foot + (top - foot) * share, z],
        scale: [0.004, (top - foot) / STALK_SPLATS / 1.6, 0.004],
        color: [0.26 * light, 0.62 * light, 0.2 * light],
      };
    }
    const petal = 2 * Math.PI * (((part - STALK_SPLATS) * GOLDEN_RATIO) % 1);
    const reach = 0.03 * Math.sqrt((part - STALK_SPLATS) / HEAD_SPLATS);
    const light = 0.7 + 10 * reach;
    return {
      position: [x + reach * Math.cos(petal), top + 0.35 * reach, z + reach * Math.sin(petal)],
      scale: [0.009, 0.004, 0.009],
      axis: [-Math.cos(petal) * 0.5, 1, -Math.sin(petal) * 0.5],
      color: HEADS[plant % HEADS.length].map((value) => value * light),
    };
  });
  return encodePly(splats);
}

const WAVE_SPLATS = 4_000;

/** A lying ring over which waves run, `share` (0…1) of the way round to where they began. */
function wavePly(share: number): Uint8Array {
  const phase = 2 * Math.PI * share;
  const splats = splatsOf(WAVE_SPLATS, (i) => {
    const around = (2 * Math.PI * i) / WAVE_SPLATS;
    const aroundTube = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const wave = Math.sin(5 * around - phase);
    const tube = 0.11 + 0.035 * Math.sin(2 * around + phase);
    const distance = 0.6 + tube * Math.cos(aroundTube);
    const light = 0.72 + 0.28 * Math.sin(aroundTube) + 0.1 * wave;
    const [red, green, blue] = wheel(i / WAVE_SPLATS, 0.5, 0.35);
    return {
      position: [
        distance * Math.cos(around),
        0.13 * wave + tube * Math.sin(aroundTube),
        distance * Math.sin(around),
      ],
      scale: 0.014,
      color: [red * light, green * light, blue * light],
    };
  });
  return encodePly(splats);
}
