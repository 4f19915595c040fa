import { expect, test, vi } from 'vitest';
import { signalOf } from '../../testing/signal.ts';
import type { GpuMemory } from '../gpu-memory.ts';
import { GpuTimer } from './gpu-timer.ts';

vi.stubGlobal('GPUBufferUsage', { QUERY_RESOLVE: 1, COPY_SRC: 2, COPY_DST: 4, MAP_READ: 8 });

/** A timer on a device whose query set is answered with `error`, or that is lost before. */
function timerWith(error: object | null, isLost = false) {
  const { when, give } = signalOf();
  const querySet = { isHeld: true, destroy: () => void Object.assign(querySet, { isHeld: false }) };
  const device = {
    features: new Set(['timestamp-query']),
    pushErrorScope: () => {},
    createQuerySet: () => querySet,
    popErrorScope: async () => {
      await when;
      if (isLost) throw new Error('lost');
      return error;
    },
  };
  const memory = { createBuffer: () => ({}), destroy: () => {} };
  const timer = new GpuTimer(device as unknown as GPUDevice, memory as unknown as GpuMemory);
  const writesOfNextFrame = () => {
    timer.begin();
    return timer.writes('sort');
  };
  /** Lets the device answer, and the timer take note. */
  const answer = async () => {
    give();
    for (let turn = 0; turn < 5; turn++) await null;
  };
  return { timer, querySet, answer, writesOfNextFrame };
}

test('times frames from the first on that is begun after the queries are known to work', async () => {
  const { timer, querySet, answer, writesOfNextFrame } = timerWith(null);
  expect(writesOfNextFrame()).toBeUndefined();
  await answer();
  expect(timer.writes('tiles'), 'of the same frame').toBeUndefined();
  expect(writesOfNextFrame()).toMatchObject({ querySet });
  timer.destroy();
  expect(querySet.isHeld).toBe(false);
});

test.each([
  ['the queries fail, as the 33rd set of a Mac does', { message: 'no sample buffer' }, false],
  ['the device is lost', null, true],
])('asks for no timestamps, and holds none, where %s', async (_, error, isLost) => {
  const { querySet, answer, writesOfNextFrame } = timerWith(error, isLost);
  await answer();
  expect(writesOfNextFrame()).toBeUndefined();
  expect(querySet.isHeld).toBe(false);
});

test('keeps no queries where it is destroyed before they are known to work', async () => {
  const { timer, querySet, answer } = timerWith(null);
  timer.destroy();
  await answer();
  expect(querySet.isHeld).toBe(false);
});
