import { expect, test } from 'vitest';
import { RecoveryPace } from './recovery-pace.ts';

test('attempts follow ever more slowly, and end', () => {
  const pace = new RecoveryPace();
  const waits = [0, 10, 1500, 6000, 23_000, 24_000].map((nowMs) => pace.next(nowMs));
  expect(waits).toEqual([0, 1000, 4000, 16_000, null, null]);
});

test('a device that has lasted a minute begins anew', () => {
  const pace = new RecoveryPace();
  expect([0, 1000, 61_000, 121_001, 121_002].map((nowMs) => pace.next(nowMs))).toEqual([
    0, 1000, 4000, 0, 1000,
  ]);
});
