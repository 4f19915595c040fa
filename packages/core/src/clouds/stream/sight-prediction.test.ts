import { expect, test } from 'vitest';
import { sightFrom } from '../../testing/sight-from.ts';
import type { CloudSight } from './cloud-sight.ts';
import { SightPrediction } from './sight-prediction.ts';

/** What is foreseen after a third of a second, by half a second of frames that vary in time. */
function predicted(path: (seconds: number) => CloudSight): readonly CloudSight[] {
  const motion = new SightPrediction();
  for (let frame = 0; frame < 30; frame++) {
    const atMs = 16 * frame + 5 * (frame % 3);
    motion.take([path(atMs / 1000)], atMs);
  }
  return motion.predict();
}
const LAST_S = (16 * 29 + 5 * 2) / 1000;

test('a walk goes on for a third of a second', () => {
  const walk = (s: number) => sightFrom([2 * s, 1, -s], [2 * s + 1, 1, 3 - s]);
  const [sight] = predicted(walk);
  const ahead = walk(LAST_S + 0.35);
  expect(sight.cut.camera.map((value, i) => Math.abs(value - ahead.cut.camera[i]) < 1e-9)).not.toContain(
    false,
  );
  for (const [i, { normal, offset }] of sight.sides.entries()) {
    expect(offset).toBeCloseTo(ahead.sides[i].offset, 6);
    for (const axis of [0, 1, 2]) expect(normal[axis]).toBeCloseTo(ahead.sides[i].normal[axis], 6);
  }
});

test.each([0.5, 2, 8])('a turn by %f rad/s goes on', (speed) => {
  const turn = (s: number) => sightFrom([5, 1, 0], [5 + Math.cos(speed * s), 1, Math.sin(speed * s)]);
  const [sight] = predicted(turn);
  const ahead = turn(LAST_S + 0.35);
  for (const [i, { normal, reach }] of sight.sides.entries()) {
    const other = ahead.sides[i].normal;
    const length = Math.hypot(...normal);
    if (length === 0) continue;
    const cosine =
      normal.reduce((sum, value, axis) => sum + value * other[axis], 0) / (length * Math.hypot(...other));
    expect(cosine).toBeCloseTo(1, 9);
    expect(reach).toBeCloseTo(ahead.sides[i].reach, 9);
  }
});

test('an orbit goes on along its circle', () => {
  const orbit = (s: number) => sightFrom([9 * Math.cos(2 * s), 4, 9 * Math.sin(2 * s)], [0, 0, 0]);
  const [sight] = predicted(orbit);
  const ahead = orbit(LAST_S + 0.35);
  for (const axis of [0, 1, 2]) expect(sight.cut.camera[axis]).toBeCloseTo(ahead.cut.camera[axis], 6);
});

test('nothing is foreseen of a view that stands, has come to rest, or shows more than before', () => {
  const sight = sightFrom([0, 1, 3], [0, 0, 0]);
  expect(predicted(() => sightFrom([0, 1, 3], [0, 0, 0]))).toEqual([]);
  const motion = new SightPrediction();
  expect(motion.predict()).toEqual([]);
  motion.take([sight], 0);
  expect(motion.predict()).toEqual([]);
  motion.take([sightFrom([1, 1, 3], [0, 0, 0])], 16);
  expect(motion.predict()).toHaveLength(1);
  motion.stop();
  expect(motion.predict()).toEqual([]);
  motion.take([sight, sight], 32);
  expect(motion.predict()).toEqual([]);
});
