import { Worker } from 'node:worker_threads';
import type { BrickTask } from '@websplatter/core/write';
import { expect, test } from 'vitest';
import { BrickThreads } from './brick-threads.ts';
import { threeSplats } from './testing/test-folder.ts';

/**
 * @fault Command line: a thread that makes bricks, or draws a reference, dies: no memory, an error, an
 *   exit
 */
test('threads that stop fail all tasks, those included that wait for one', async () => {
  const threads = new BrickThreads(2, () => new Worker('process.exit(3)', { eval: true }));
  const tasks = Array.from({ length: 7 }, (): BrickTask => ({ kind: 'records', set: threeSplats() }));
  const outcomes = await Promise.allSettled(tasks.map(threads.run));
  expect(outcomes).toHaveLength(7);
  for (const outcome of outcomes)
    expect(outcome).toMatchObject({
      status: 'rejected',
      reason: { code: 'worker-failed', message: expect.stringMatching(/^convert: a thread stopped: /) },
    });
  await threads.end();
});
