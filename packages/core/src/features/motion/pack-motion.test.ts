// Proves: the reach of a chunk bounds every displacement that its splats have while they can be seen.
import { expect, test } from 'vitest';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { opacityOf } from '../../data/splats/color-values.ts';
import { movingSplats } from '../../testing/moving-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { packMotion, timeIntervalOf } from './pack-motion.data.ts';
import { MOST_MOTION, MOTION_SLOT, MOTION_VALUES, motionAt } from './splat-motion.data.ts';

const { REACH_WORDS, TIME_INTERVALS } = SHADER_CONSTANTS;
const SET = movingSplats({ count: 600, seed: 5, shDegree: 0 });

test('bounds the displacements of visible splats at any time, tightly', () => {
  const { reaches, range } = packMotion(SET)!;
  const random = seededRandom(6);
  let [used, beyond] = [0, 0];
  for (let trial = 0; trial < 100; trial++) {
    const time = trial === 0 ? 0 : trial === 1 ? 1 : random();
    for (let i = 0; i < SET.count; i++) {
      const { displacement, share } = motionAt(SET.motion, i * MOTION_VALUES, time);
      if (share * opacityOf(SET.opacityLogits[i]) < 1 / 4096) continue;
      const chunk = Math.floor(i / CHUNK_SPLATS);
      const at = (chunk * TIME_INTERVALS + timeIntervalOf(range, time)) * REACH_WORDS;
      for (let axis = 0; axis < 3; axis++) {
        const [least, most] = [reaches[at + axis], reaches[at + 3 + axis]];
        // Also if one of them is no number.
        if (!(least <= displacement[axis] && displacement[axis] <= most)) beyond++;
        used = Math.max(used, displacement[axis] / most);
      }
    }
  }
  expect(beyond).toBe(0);
  expect(used).toBeGreaterThan(0.95);
});

test('finds where a motion turns around within an interval', () => {
  const motion = new Float32Array(MOTION_VALUES);
  // Upwards until 1/64 after its time, then back: highest in the middle of the first interval.
  motion.set([0, 5, 1, 0, 0, -32, 0, 0], MOTION_SLOT.time);
  const { reaches } = packMotion({ ...movingSplats({ count: 1 }), motion })!;
  expect(reaches[3]).toBeCloseTo(1 / 128, 6);
  expect(reaches[0]).toBeCloseTo(0, 4);
});

test('chunks without a splat that can be seen are empty', () => {
  const motion = new Float32Array(MOTION_VALUES);
  motion.set([0.5, -5], MOTION_SLOT.time);
  const { reaches } = packMotion({ ...movingSplats({ count: 1 }), motion })!;
  const seen = Array.from(
    { length: TIME_INTERVALS },
    (_, i) => reaches[i * REACH_WORDS] <= reaches[i * REACH_WORDS + 3],
  );
  expect(seen.slice(13, 19).filter(Boolean).length).toBeGreaterThan(1);
  expect([...seen.slice(0, 14), ...seen.slice(18)]).not.toContain(true);
});

test('times beyond 0 to 1 widen the range', () => {
  const motion = SET.motion.slice();
  motion[MOTION_SLOT.time] = -2;
  motion[MOTION_VALUES + MOTION_SLOT.time] = 30;
  expect(packMotion({ ...SET, motion })!.range).toEqual([-2, 30]);
  expect(timeIntervalOf([-2, 30], 30)).toBe(TIME_INTERVALS - 1);
  expect(timeIntervalOf([-2, 30], -1.5)).toBe(0);
});

test('everything packed is finite, up to the values that files may have', () => {
  const motion = new Float32Array(MOTION_VALUES).fill(MOST_MOTION);
  // Its opacity never falls, so that each interval has all of its way.
  motion[MOTION_SLOT.logDuration] = 80;
  for (const rotation of [1, 1e-45, 3e38]) {
    const rotations = new Float32Array([rotation, rotation, 0, 0]);
    const { words, reaches } = packMotion({ ...movingSplats({ count: 1 }), rotations, motion })!;
    expect([...words, ...reaches].every(Number.isFinite)).toBe(true);
    expect([...reaches.slice(0, 3)].every((least) => least < -0.99e24)).toBe(true);
  }
});
