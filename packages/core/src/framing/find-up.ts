import type { Vec3 } from '../data/math/mat4.ts';
import { cross, dot, negated, unit } from '../data/math/vec3.ts';
import { sinCos } from './portable-math.ts';
import type { SceneDetail } from './scene-detail.ts';
import { weightedQuantile, weightedQuantiles } from './weighted-quantile.ts';

const GOLDEN_TURN = 0.6180339887498949;

/** Splats that are asked, and directions that are tried. */
const MOST_FLAT = 4096;
const DIRECTIONS = hemisphere(400);
const FEWEST_FLAT = 100;
/** Cosines. A floor's shortest axis is within 20° of up; a wall's is within 11.5° of horizontal. */
const ALONG = 0.94;
const ACROSS = 0.2;
/** Shares of all directions that are as near to an axis, or to the plane across it. */
const RANDOM_ALONG = 1 - ALONG;
const RANDOM_ACROSS = ACROSS;
/**
 * Least score of a direction that tells anything, 3 if normals point anywhere: of places, and of
 * objects, which have no floor.
 */
const TELLING = { place: 4.8, object: 5.5 } as const;
/**
 * An axis of the file with so much of the best score is up; less is enough for one along which the
 * scene is flat, as walls of a room tell of every axis.
 */
const ALMOST = { place: 0.9, object: 0.8, flat: 0.7 } as const;
/** Part of the least extent across an axis, along which a flat scene extends less. */
const FLAT = 0.6;
/** Most files keep to the convention, where nothing tells against it. */
export const USUAL_CONFIDENCE = 0.6;
/** Cosine of 10°: nearer directions are that axis. */
const NEAR_AXIS = 0.984807753012208;
/** Splats by which the ground is found. */
const MOST_NEAR = 8192;
const GROUND_BINS = 40;
/** A floor is looked for in so many of them. */
const BOTTOM_BINS = 6;

/** Up direction of a scene, with the ground. */
export interface FoundUp {
  /** Unit vector. */
  readonly up: Vec3;
  /** 0…1: below about 0.5 another is as likely. */
  readonly confidence: number;
  /** Height of the ground along up from the centre, in units of the detail; null if none was found. */
  readonly ground: number | null;
  /** Whether the ground seems to lie above all else: a ceiling, or up is down. */
  readonly isCeiling: boolean;
}

/** Result for a known up direction: full confidence, and the ground below. */
export function knownUp(detail: SceneDetail, up: Vec3): FoundUp {
  const { height, isCeiling } = findGround(detail, up);
  return { up, confidence: 1, ground: isCeiling ? null : height, isCeiling: false };
}

/** Flat splats of a scene, and the up direction that most of them support. */
export interface Surfaces {
  readonly flat: FlatSplats;
  /** Direction that most flat splats support as up, with either sign; `bestScore` says how clearly. */
  readonly best: Vec3;
  readonly bestScore: number;
}

/** Looks for floors, whose splats have their shortest axis along up, and for walls, across it. */
export function findSurfaces(detail: SceneDetail): Surfaces {
  const flat = flatSplats(detail);
  let best = DIRECTIONS[0];
  let bestScore = 0;
  if (flat.count < FEWEST_FLAT) return { flat, best, bestScore };
  for (const direction of DIRECTIONS) {
    const score = upScore(flat, direction);
    if (score > bestScore) [best, bestScore] = [direction, score];
  }
  for (const cone of [0.94, 0.97, 0.985]) best = meanNormal(flat, best, cone);
  return { flat, best, bestScore };
}

/**
 * Finds up.
 *
 * @param convention unit vector that is up in most files of the format; the fallback.
 * @param by evidence: floors and walls (`place`) or sides (`object`), if they are clear enough;
 *   `surfaces` even if they are not; or the `convention` alone.
 */
export function findUp(
  detail: SceneDetail,
  surfaces: Surfaces,
  convention: Vec3,
  by: 'place' | 'object' | 'surfaces' | 'convention',
): FoundUp {
  const up =
    by === 'convention'
      ? convention
      : by === 'surfaces'
        ? signed(surfaces.best, convention)
        : chooseUp(detail, surfaces, convention, by);
  const { height, isCeiling } = findGround(detail, up);
  const told = Math.min(1, Math.max(0, (surfaces.bestScore - 3) / 4));
  const confidence = up === convention ? Math.max(USUAL_CONFIDENCE, told) : told;
  return { up, confidence, ground: height, isCeiling };
}

/** The same scene upside down. */
export function turnedOver({ up, confidence, ground }: FoundUp): FoundUp {
  return { up: negated(up), confidence, ground: ground === null ? null : -ground, isCeiling: false };
}

function chooseUp(
  detail: SceneDetail,
  { flat, best, bestScore }: Surfaces,
  convention: Vec3,
  of: 'place' | 'object',
): Vec3 {
  if (bestScore < TELLING[of]) return convention;
  const z: Vec3 = [0, 0, 1];
  const enough = isFlatAlong(detail, convention) ? ALMOST.flat : ALMOST[of];
  const usualScore = upScore(flat, convention);
  const isMap = of === 'place' && upScore(flat, z) > usualScore && isFlatAlong(detail, z);
  if (usualScore > enough * bestScore && !isMap) return convention;
  const [towards, towardsZ] = [dot(best, convention), best[2]];
  if (Math.max(Math.abs(towards), Math.abs(towardsZ)) > NEAR_AXIS)
    return Math.abs(towards) >= Math.abs(towardsZ) ? convention : z;
  if (upScore(flat, z) > ALMOST.place * bestScore) return z;
  return signed(best, convention);
}

/** The direction that points towards the convention, or towards z. */
function signed(direction: Vec3, convention: Vec3): Vec3 {
  const towards = dot(direction, convention);
  return (Math.abs(towards) < 0.2 ? direction[2] : towards) < 0 ? negated(direction) : direction;
}

/** Whether a scene is lower along an axis than it is wide across it, as rooms and places are. */
function isFlatAlong({ count, x, y, z, nearDetails }: SceneDetail, axis: Vec3): boolean {
  const across = unit(cross(axis, Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  const [along, ...others] = [axis, across, cross(axis, across)].map((direction) => {
    const values = x.map((value, i) => value * direction[0] + y[i] * direction[1] + z[i] * direction[2]);
    const [low, high] = weightedQuantiles(values, nearDetails, count, [0.05, 0.95]);
    return high - low;
  });
  return along < FLAT * Math.min(...others);
}

/** Splats of surfaces. */
interface FlatSplats {
  readonly count: number;
  readonly normals: Float64Array;
  /** Sum: 1. */
  readonly weights: Float64Array;
}

function flatSplats({ count, distances, reach, sigmas, opacities, normals }: SceneDetail): FlatSplats {
  const isFlat = (i: number) =>
    distances[i] < reach && opacities[i] > 0.2 && sigmas[3 * i] < 0.5 * sigmas[3 * i + 1];
  let found = 0;
  for (let i = 0; i < count; i++) if (isFlat(i)) found++;
  const step = Math.max(1, found / MOST_FLAT);
  const rows: number[] = [];
  for (let i = 0, seen = 0; i < count; i++) if (isFlat(i) && seen++ >= rows.length * step) rows.push(i);
  const areas = Float64Array.from(rows, (i) => sigmas[3 * i + 1] * sigmas[3 * i + 2]);
  const largest = weightedQuantile(
    areas,
    areas.map(() => 1),
    areas.length,
    0.8,
  );
  const weights = Float64Array.from(
    rows,
    (i, k) => opacities[i] * Math.min(areas[k], largest) * (1 - sigmas[3 * i] / sigmas[3 * i + 1]),
  );
  const total = weights.reduce((sum, weight) => sum + weight, 0);
  return {
    count: rows.length,
    normals: Float64Array.from(
      { length: 3 * rows.length },
      (_, k) => normals[3 * rows[Math.floor(k / 3)] + (k % 3)],
    ),
    weights: weights.map((weight) => weight / total),
  };
}

/** How many times more surfaces than by chance lie along and, twice, across: 3 by chance. */
function upScore({ count, normals, weights }: FlatSplats, up: Vec3): number {
  let along = 0;
  let across = 0;
  for (let i = 0; i < count; i++) {
    const cosine = Math.abs(normals[3 * i] * up[0] + normals[3 * i + 1] * up[1] + normals[3 * i + 2] * up[2]);
    if (cosine > ALONG) along += weights[i];
    else if (cosine < ACROSS) across += weights[i];
  }
  return along / RANDOM_ALONG + (2 * across) / RANDOM_ACROSS;
}

/** The mean of the normals within a cone about `axis`, which may point either way. */
function meanNormal({ count, normals, weights }: FlatSplats, axis: Vec3, cone: number): Vec3 {
  let [x, y, z] = [1e-9 * axis[0], 1e-9 * axis[1], 1e-9 * axis[2]];
  for (let i = 0; i < count; i++) {
    const cosine = normals[3 * i] * axis[0] + normals[3 * i + 1] * axis[1] + normals[3 * i + 2] * axis[2];
    if (Math.abs(cosine) <= cone) continue;
    const weight = cosine < 0 ? -weights[i] : weights[i];
    x += weight * normals[3 * i];
    y += weight * normals[3 * i + 1];
    z += weight * normals[3 * i + 2];
  }
  return unit([x, y, z]);
}

/**
 * Where most surfaces lie flat. If nearly all else is below that, and nothing lies flat at the bottom,
 * it is the ground, and up is down; a room has a ceiling and a floor.
 */
function findGround(
  { count, x, y, z, distances, farReach, opacities, sigmas, normals, details }: SceneDetail,
  up: Vec3,
): { readonly height: number | null; readonly isCeiling: boolean } {
  const near: number[] = [];
  const step = Math.max(1, Math.floor(count / MOST_NEAR));
  for (let i = 0; i < count; i += step) if (distances[i] < farReach) near.push(i);
  const ones = new Float64Array(near.length).fill(1);
  const heights = Float64Array.from(near, (i) => x[i] * up[0] + y[i] * up[1] + z[i] * up[2]);
  const [low, high] = weightedQuantiles(heights, ones, near.length, [0.005, 0.995]);
  if (!(high > low)) return { height: null, isCeiling: false };
  const areas = Float64Array.from(near, (i) => sigmas[3 * i + 1] * sigmas[3 * i + 2]);
  const largest = weightedQuantile(areas, ones, near.length, 0.9);
  const bins = new Float64Array(GROUND_BINS);
  let flatTotal = 0;
  for (const [k, i] of near.entries()) {
    const cosine = normals[3 * i] * up[0] + normals[3 * i + 1] * up[1] + normals[3 * i + 2] * up[2];
    const bin = Math.floor(((heights[k] - low) / (high - low)) * GROUND_BINS);
    if (Math.abs(cosine) <= 0.9 || bin < 0 || bin >= GROUND_BINS) continue;
    bins[bin] += opacities[i] * Math.min(areas[k], largest);
  }
  const smooth = bins.map((value, k) => value + (bins[k - 1] ?? 0) + (bins[k + 1] ?? 0));
  for (const value of smooth) flatTotal += value;
  let peak = 0;
  for (let k = 1; k < GROUND_BINS; k++) if (smooth[k] > smooth[peak]) peak = k;
  if (!(smooth[peak] > 0.1 * flatTotal)) return { height: null, isCeiling: false };
  const height = low + ((peak + 0.5) / GROUND_BINS) * (high - low);
  const margin = 0.05 * (high - low);
  let [above, below] = [0, 0];
  for (const [k, i] of near.entries()) {
    if (heights[k] > height + margin) above += details[i];
    else if (heights[k] < height - margin) below += details[i];
  }
  let bottom = 0;
  for (let k = 0; k < BOTTOM_BINS; k++) bottom += bins[k];
  const isFloorless = bottom < 0.45 * smooth[peak];
  return { height, isCeiling: above < 0.2 * below && isFloorless };
}

/** Directions spread evenly over the half of a sphere with z ≥ 0. */
function hemisphere(count: number): Vec3[] {
  return Array.from({ length: count }, (_, i) => {
    const z = 1 - (i + 0.5) / count;
    const radius = Math.sqrt(1 - z * z);
    const [sin, cos] = sinCos(2 * Math.PI * ((i * GOLDEN_TURN) % 1));
    return [radius * cos, radius * sin, z];
  });
}
