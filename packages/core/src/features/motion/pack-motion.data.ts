import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { normalizedRotation, productOf } from '../../data/packing/rotation.ts';
import { opacityOf } from '../../data/splats/color-values.ts';
import type { SplatColumns } from '../../data/splats/splat-set.ts';
import { durationOf, MOTION_SLOT, MOTION_VALUES, type TimeRange, timeRangeOf } from './splat-motion.data.ts';

const { MOST_ELAPSED, MOTION_WORDS, REACH_WORDS, TIME_INTERVALS } = SHADER_CONSTANTS;

/** How splats move, as uploaded; in storage order. Read by features/motion/motion.wgsl. */
export interface PackedMotion {
  readonly range: TimeRange;
  /**
   * MOTION_WORDS per splat: velocity, time | acceleration, 1 / duration | jerk, 0 | the turn w, x, y, z
   * as a quaternion in the splat's own frame, in lengths of the trained rotation, so that it holds for
   * the unit quaternion that is stored, and for either sign of it.
   */
  readonly words: Float32Array<ArrayBuffer>;
  /**
   * REACH_WORDS per chunk and interval, the intervals of a chunk one after another: bounds of how far
   * its splats are displaced, about their own places. The least is above the greatest if none of them
   * can be seen in the interval.
   */
  readonly reaches: Float32Array<ArrayBuffer>;
}

/** A splat is invisible this many durations from its time: its opacity is e⁻¹⁶, 1e-7, of its own. */
const MOST_DURATIONS = 4;
/** Displacements in float32 are off by less than this part of their terms. */
const ROUNDING = 1e-6;
/** Longest turn in lengths of a rotation: float32 has to hold the sum of four of its products with MOST_ELAPSED. */
const MOST_SPIN = 1e30;
/** Part of an interval by which a time in float32 may be outside of it. */
const TIME_SLACK = 1e-3;

/**
 * GPU bytes of the motion of `count` splats.
 *
 * @hidden Shared with the packages beside this one.
 */
export function motionBytesOf(count: number): number {
  return 4 * (count * MOTION_WORDS + chunkCountOf(count) * TIME_INTERVALS * REACH_WORDS);
}

/** Index of the interval that holds a time; the first or last for a time outside of the range. */
export function timeIntervalOf([from, to]: TimeRange, time: number): number {
  const interval = Math.floor(((time - from) / (to - from)) * TIME_INTERVALS);
  return Math.max(0, Math.min(TIME_INTERVALS - 1, interval));
}

/** Packs the motion of splats in storage order; null if they stand still. */
export function packMotion(stored: SplatColumns): PackedMotion | null {
  const { motion, count } = stored;
  if (!motion) return null;
  const range = timeRangeOf(motion);
  const words = new Float32Array(count * MOTION_WORDS);
  const reaches = emptyReaches(chunkCountOf(count));
  const rotation = new Float64Array(4);
  for (let i = 0; i < count; i++) {
    const from = i * MOTION_VALUES;
    const to = i * MOTION_WORDS;
    for (let axis = 0; axis < 3; axis++) {
      words[to + axis] = motion[from + MOTION_SLOT.velocity + axis];
      words[to + 4 + axis] = motion[from + MOTION_SLOT.acceleration + axis];
      words[to + 8 + axis] = motion[from + MOTION_SLOT.jerk + axis];
    }
    words[to + 3] = motion[from + MOTION_SLOT.time];
    words[to + 7] = 1 / durationOf(motion[from + MOTION_SLOT.logDuration]);
    words.set(spinOf(stored, i, rotation), to + 12);
    if (opacityOf(stored.opacityLogits[i]) > 0)
      widen(reaches, Math.floor(i / CHUNK_SPLATS), motion, from, range);
  }
  return { range, words, reaches };
}

/**
 * The turn of splat `i` in its own frame: rotation⁻¹ · turn / |rotation|, as quaternions. A longer one
 * than MOST_SPIN is shortened: after an elapsed time of more than 1e-24 the sum with the rotation has
 * its direction all the same. Before that time, which is no float32 beside other times than 0, the
 * splat turns later than in float64.
 */
function spinOf({ rotations, motion }: SplatColumns, i: number, unit: Float64Array): readonly number[] {
  normalizedRotation(rotations, 4 * i, unit);
  const at = i * MOTION_VALUES + MOTION_SLOT.turn;
  const [w, x, y, z] = rotations.subarray(4 * i, 4 * i + 4);
  const length = Math.hypot(w, x, y, z) || 1;
  const turn = [0, 1, 2, 3].map((k) => motion![at + k] / length);
  const spin = productOf([unit[0], -unit[1], -unit[2], -unit[3]], turn);
  const largest = Math.max(...spin.map(Math.abs));
  return largest > MOST_SPIN ? spin.map((value) => value * (MOST_SPIN / largest)) : spin;
}

function emptyReaches(chunks: number): Float32Array<ArrayBuffer> {
  const reaches = new Float32Array(chunks * TIME_INTERVALS * REACH_WORDS);
  // Finite, since shaders may assume that there are no infinities.
  for (let at = 0; at < reaches.length; at += REACH_WORDS)
    reaches.fill(1, at, at + 3).fill(-1, at + 3, at + 6);
  return reaches;
}

/** Widens a chunk's reaches by a splat's, in each interval in which the splat is visible. */
function widen(
  reaches: Float32Array,
  chunk: number,
  motion: Float32Array,
  at: number,
  range: TimeRange,
): void {
  const time = motion[at + MOTION_SLOT.time];
  const seen = MOST_DURATIONS * durationOf(motion[at + MOTION_SLOT.logDuration]);
  const end = timeIntervalOf(range, time + seen);
  const step = (range[1] - range[0]) / TIME_INTERVALS;
  for (let interval = timeIntervalOf(range, time - seen); interval <= end; interval++) {
    const begin = range[0] + interval * step - time;
    const from = Math.max(-seen, begin - TIME_SLACK * step);
    const to = Math.min(seen, begin + (1 + TIME_SLACK) * step);
    if (from > to) continue;
    // As far as the shader moves it: further, the third power would leave float32's range.
    const [first, last] = [from, to].map((elapsed) =>
      Math.max(-MOST_ELAPSED, Math.min(MOST_ELAPSED, elapsed)),
    );
    const reach = (chunk * TIME_INTERVALS + interval) * REACH_WORDS;
    const isFirst = reaches[reach] > reaches[reach + 3];
    for (let axis = 0; axis < 3; axis++) {
      const [least, greatest] = displacementsOf(motion, at + MOTION_SLOT.velocity + axis, first, last);
      reaches[reach + axis] = isFirst ? least : Math.min(reaches[reach + axis], least);
      reaches[reach + 3 + axis] = isFirst ? greatest : Math.max(reaches[reach + 3 + axis], greatest);
    }
  }
}

/** Least and greatest displacement along an axis from `from` to `to` after the splat's time. */
function displacementsOf(
  motion: Float32Array,
  at: number,
  from: number,
  to: number,
): readonly [number, number] {
  const [v, a, j] = [motion[at], motion[at + 3], motion[at + 6]];
  const values = [from, to, ...turningPoints(v, a, j).filter((d) => d > from && d < to)].map(
    (d) => d * (v + d * (a + d * j)),
  );
  const most = Math.max(Math.abs(from), Math.abs(to));
  const slack = ROUNDING * most * (Math.abs(v) + most * (Math.abs(a) + most * Math.abs(j)));
  return [Math.min(...values) - slack, Math.max(...values) + slack];
}

/** Where v·d + a·d² + j·d³ turns around: the roots of its derivative. */
function turningPoints(v: number, a: number, j: number): readonly number[] {
  if (j === 0) return a === 0 ? [] : [-v / (2 * a)];
  const discriminant = a * a - 3 * j * v;
  if (!(discriminant > 0)) return [];
  // The root of larger magnitude, then the other by Vieta: nothing cancels.
  const q = -(a + (a < 0 ? -1 : 1) * Math.sqrt(discriminant));
  return [q / (3 * j), v / q];
}
