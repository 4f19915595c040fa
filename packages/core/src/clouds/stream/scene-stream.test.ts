import { expect, onTestFinished, test } from 'vitest';
import type { BrickScene } from '../../data/bricks/brick.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { SplatSourceError } from '../../data/errors.ts';
import { nextTask } from '../../data/turns.ts';
import { FakeBrickPool } from '../../testing/fake-brick-pool.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { reportedErrors } from '../../testing/reported-errors.ts';
import { BrickParts } from '../bricks/brick-parts.ts';
import type { BrickPool } from '../bricks/brick-pool.ts';
import type { StreamReport } from './cloud-stream.ts';
import { SceneStream } from './scene-stream.ts';

const whole = brickSceneOf(randomSplats({ count: 20_000, seed: 2, shDegree: 0 }));
/** Sees all of the scene, in full. */
const SIGHT = {
  cut: { camera: [0, 0, 2], squaredPerDistance: 1e-9, leastSquared: 1e-12, margin: 0 },
  squaredShift: 1,
  sides: [],
} as const;

async function begin(read: BrickScene['read'] = whole.read): Promise<SceneStream> {
  const pool = new FakeBrickPool();
  const root = pool.place(await whole.read(whole.root), whole.root, null);
  const stream = new SceneStream(new BrickParts({ ...whole, read }, pool as unknown as BrickPool, root));
  onTestFinished(() => stream.end());
  return stream;
}

function look(stream: SceneStream): void {
  stream.setSights(stream, [SIGHT], async () => {});
  stream.onFrame();
}

/**
 * @fault Listeners: a listener of a stream throws
 * @consequence the stream goes on; views, clouds and engine end, and free everything
 */
test('a listener that throws stops neither its stream, nor other listeners, nor the end', async () => {
  const reported = reportedErrors();
  const error = new Error('of a listener');
  const stream = await begin();
  stream.subscribe(() => {
    throw error;
  });
  const reports: StreamReport[] = [];
  stream.subscribe(() => reports.push(stream.report()));
  look(stream);
  await expect.poll(() => reports.at(-1)).toMatchObject({ isComplete: true });
  expect(stream.report().residentBricks).toBe(whole.brickCount);
  expect(reported.length).toBeGreaterThan(0);
  expect(new Set(reported)).toEqual(new Set([error]));
  stream.leave(stream);
  stream.end();
  expect(stream.complete).toBeNull();
  // The last call.
  await nextTask();
  await nextTask();
});

test('a listener is told of a change to a report that others saw before it came', async () => {
  const stream = await begin();
  const stop = stream.subscribe(() => {});
  look(stream);
  await stream.complete;
  stream.leave(stream);
  stop();
  // The call that was due finds nobody, and a report that is not complete.
  await nextTask();
  await nextTask();
  look(stream);
  await stream.complete;
  expect(stream.report().isComplete).toBe(true);
  const reports: StreamReport[] = [];
  stream.subscribe(() => reports.push(stream.report()));
  stream.leave(stream);
  await expect.poll(() => reports).toMatchObject([{ isComplete: false }]);
});

test('listeners are called after changes, once for all of a task, where the report is another one', async () => {
  const stream = await begin();
  let isChanging = false;
  let calls = 0;
  stream.subscribe(() => {
    expect(isChanging).toBe(false);
    calls++;
    // Draws what has changed, as pages do.
    look(stream);
  });
  const change = (work: () => void) => {
    isChanging = true;
    work();
    isChanging = false;
  };
  change(() => look(stream));
  await expect.poll(() => stream.report().isComplete).toBe(true);
  let before: number;
  do {
    before = calls;
    await nextTask();
    await nextTask();
  } while (calls > before);
  for (let i = 0; i < 20; i++) {
    change(() => look(stream));
    await nextTask();
  }
  expect(calls).toBe(before);
  change(() => stream.leave(stream));
  await expect.poll(() => calls).toBeGreaterThan(before);
  change(() => stream.end());
});

/**
 * @fault Listeners: a listener of a stream retries, or draws, each time
 * @consequence other listeners run in between; it is called only for another report
 */
test('a listener that retries whatever fails leaves others their turns', async () => {
  let reads = 0;
  const error = new SplatSourceError('a scene', 'gone');
  const stream = await begin(async () => {
    reads++;
    throw error;
  });
  let retries = 0;
  const MANY = 10_000;
  stream.subscribe(() => {
    if (retries++ < MANY) stream.retry();
  });
  look(stream);
  await expect.poll(() => reads).toBeGreaterThan(4);
  expect(retries).toBeLessThan(MANY);
  expect(stream.report().residentBricks).toBe(1);
});

test('without an error there is nothing to retry', async () => {
  const stream = await begin();
  look(stream);
  await stream.complete;
  stream.retry();
  expect(stream.complete).toBeNull();
  stream.end();
  stream.retry();
  expect(stream.report()).toMatchObject({ error: null });
});
