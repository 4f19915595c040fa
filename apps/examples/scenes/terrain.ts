import { encodePly } from '@websplatter/core';
import { hash, splatsOf } from './splats.ts';

const SIDE = 140;
const WIDTH = 1.7;
const SEA_HEIGHT = -0.03;

/** An island of hills with snowy tops, surrounded by sea, lit from the left. */
export function terrainPly(): Uint8Array {
  const splats = splatsOf(SIDE ** 2, (i) => {
    const at = (index: number, seed: number) => ((index + hash(i, seed)) / SIDE - 0.5) * WIDTH;
    const [x, z] = [at(i % SIDE, 1), at(Math.floor(i / SIDE), 2)];
    const ground = height(x, z);
    const isSea = ground < SEA_HEIGHT;
    const step = 0.004;
    const axis = isSea
      ? [0, 1, 0]
      : [(ground - height(x + step, z)) / step, 1, (ground - height(x, z + step)) / step];
    const light = Math.max(0.25, (axis[1] - 0.7 * axis[0]) / Math.hypot(...axis) / 1.22);
    const shade = (isSea ? 0.95 : light) * (0.92 + 0.16 * hash(i, 3));
    return {
      position: [x, Math.max(ground, SEA_HEIGHT), z],
      scale: [0.011, 0.003, 0.011],
      axis,
      color: colorAt(ground).map((value) => value * shade),
      // The sea fades out towards its edge.
      opacityLogit: isSea ? 12 * (0.8 - Math.hypot(x, z)) : 3,
    };
  });
  return encodePly(splats);
}

function height(x: number, z: number): number {
  const ridges =
    0.16 * Math.sin(4.1 * x + 1.3) * Math.cos(3.7 * z - 0.4) +
    0.07 * Math.sin(9.3 * x - 2.1 * z) +
    0.035 * Math.cos(17 * z + 6 * x) +
    0.014 * Math.sin(39 * x + 23 * z);
  return 0.32 * Math.exp(-3.4 * (x * x + z * z)) + ridges - 0.42 * (x * x + z * z);
}

function colorAt(ground: number): number[] {
  if (ground < SEA_HEIGHT - 0.06) return [0.13, 0.36, 0.62];
  if (ground < SEA_HEIGHT) return [0.2, 0.6, 0.72];
  if (ground < 0.01) return [0.93, 0.84, 0.6];
  if (ground < 0.17) return [0.38, 0.6, 0.26];
  if (ground < 0.3) return [0.58, 0.5, 0.42];
  return [0.99, 0.99, 1];
}
