import { expect, test } from 'vitest';
import { RecoveryPace } from './recovery-pace.ts';

/**
 * @fault Devices and engines: the device is lost again and again
 * @consequence attempts after 0, 1, 4 and 16 s, then none
 */
test('attempts follow ever more slowly, and end', () => {
  const pace = new RecoveryPace();
  const waits = [0, 10, 1500, 6000, 23_000, 24_000].map((nowMs) => pace.next(nowMs));
  expect(waits).toEqual([0, 1000, 4000, 16_000, null, null]);
});

test('a device that has lasted a minute since all was on the screen begins anew', () => {
  const pace = new RecoveryPace();
  expect([pace.next(0), pace.next(1000)]).toEqual([0, 1000]);
  pace.recovered(5000);
  // As frames go on.
  pace.recovered(64_000);
  expect(pace.next(65_001)).toBe(0);
  pace.recovered(70_000);
  expect(pace.next(130_000)).toBe(1000);
});

/**
 * @fault Devices and engines: a scene that takes minutes to load takes the GPU down, again and again
 * @consequence attempts end as well: only time after a whole image counts as lasting
 */
test('rounds that take minutes until all is on the screen, or never get there, end too', () => {
  const pace = new RecoveryPace();
  const waits = [0, 1, 2, 3, 4].map((round) => {
    const wait = pace.next(round * 300_000);
    if (round % 2 === 0) pace.recovered(round * 300_000 + 290_000);
    return wait;
  });
  expect(waits).toEqual([0, 1000, 4000, 16_000, null]);
});
