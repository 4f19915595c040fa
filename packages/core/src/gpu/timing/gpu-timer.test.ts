import { expect, test, vi } from 'vitest';
import { signalOf } from '../../testing/signal.ts';
import type { GpuMemory } from '../gpu-memory.ts';
import { GpuTimer } from './gpu-timer.ts';

vi.stubGlobal('GPUBufferUsage', { QUERY_RESOLVE: 1, COPY_SRC: 2, COPY_DST: 4, MAP_READ: 8 });
vi.stubGlobal('GPUMapMode', { READ: 1 });

/** A timer on a device whose query sets are answered with `error`, or that is lost before. */
function timerWith(error: object | null, isLost = false) {
  const { when, give } = signalOf();
  const made: { isHeld: boolean }[] = [];
  const makeQuerySet = () => {
    const querySet = { isHeld: true, destroy: () => void Object.assign(querySet, { isHeld: false }) };
    made.push(querySet);
    return querySet;
  };
  const device = {
    features: new Set(['timestamp-query']),
    pushErrorScope: () => {},
    createQuerySet: makeQuerySet,
    popErrorScope: async () => {
      await when;
      if (isLost) throw new Error('lost');
      return error;
    },
  };
  const memory = { createBuffer: () => ({}), destroy: () => {}, map: vi.fn() };
  const makeTimer = () => new GpuTimer(device as unknown as GPUDevice, memory as unknown as GpuMemory);
  const timer = makeTimer();
  const writesOfNextFrame = (timer: GpuTimer) => {
    timer.begin();
    return timer.writes('sort');
  };
  /** Lets the device answer, and the timer take note. */
  const answer = async () => {
    give();
    for (let turn = 0; turn < 10; turn++) await null;
  };
  const held = () => made.filter(({ isHeld }) => isHeld);
  return { timer, makeTimer, made, held, memory, answer, writesOfNextFrame };
}

test('times frames from the first on that is begun after the queries are known to work', async () => {
  const { timer, made, held, answer, writesOfNextFrame } = timerWith(null);
  expect(writesOfNextFrame(timer)).toBeUndefined();
  await answer();
  expect(timer.writes('tiles'), 'of the same frame').toBeUndefined();
  expect(writesOfNextFrame(timer)?.querySet).toBe(made[0]);
  timer.destroy();
  expect(held()).toEqual([made[1]]);
});

test('times the first frame, too, after another timer of the device, and holds one set to spare', async () => {
  const { made, held, makeTimer, answer, writesOfNextFrame } = timerWith(null);
  await answer();
  const second = makeTimer();
  expect(writesOfNextFrame(second)?.querySet).toBe(made[1]);
  await answer();
  const third = makeTimer();
  expect(writesOfNextFrame(third)?.querySet).toBe(made[2]);
  await answer();
  expect(made).toHaveLength(4);
  second.destroy();
  third.destroy();
  expect(held()).toEqual([made[0], made[3]]);
});

/**
 * @fault Other WebGPUs: timestamp queries do not work
 * @consequence none are kept, and frames are drawn without them
 */
test.each([
  ['the queries fail, as the 33rd set of a Mac does', { message: 'no sample buffer' }, false],
  ['the device is lost', null, true],
])('asks for no timestamps, and holds none, where %s', async (_, error, isLost) => {
  const { timer, held, answer, writesOfNextFrame } = timerWith(error, isLost);
  await answer();
  expect(writesOfNextFrame(timer)).toBeUndefined();
  expect(held()).toEqual([]);
});

test('keeps no queries where it is destroyed before they are known to work', async () => {
  const { timer, held, answer } = timerWith(null);
  timer.destroy();
  await answer();
  expect(held()).toEqual([]);
});

test('maps nothing of a frame whose view is destroyed right after it', async () => {
  const { timer, memory, writesOfNextFrame } = timerWith(null);
  writesOfNextFrame(timer);
  timer.destroy();
  expect(await timer.read({ frame: 1, loadedSplats: 1, cutErrorPx: null })).toBeNull();
  expect(memory.map).not.toHaveBeenCalled();
});
