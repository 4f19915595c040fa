import { MessageChannel, Worker } from 'node:worker_threads';
import { InvalidArgumentError, SplatFileError } from '@websplatter/core';
import { type BrickTask, runBrickTask } from '@websplatter/core/write';
import { expect, test, vi } from 'vitest';
import { BrickThreads } from './brick-threads.ts';
import { threeSplats } from './testing/test-folder.ts';

vi.mock('@websplatter/core/write', async (original) => ({
  ...(await original<object>()),
  runBrickTask: vi.fn(),
}));

const task = (): BrickTask => ({ kind: 'records', set: threeSplats() });

/**
 * @fault Command line: a thread that makes bricks, or draws a reference, dies: no memory, an error, an
 *   exit
 */
test('threads that stop fail all tasks, those included that wait for one', async () => {
  const threads = new BrickThreads(2, () => new Worker('process.exit(3)', { eval: true }));
  const tasks = Array.from({ length: 7 }, task);
  const outcomes = await Promise.allSettled(tasks.map(threads.run));
  expect(outcomes).toHaveLength(7);
  for (const outcome of outcomes)
    expect(outcome).toMatchObject({
      status: 'rejected',
      reason: { code: 'worker-failed', message: expect.stringMatching(/^convert: a thread stopped: /) },
    });
  await threads.end();
});

test('typed errors of a thread arrive with their classes and fields', async () => {
  const { port1, port2 } = new MessageChannel();
  vi.doMock('node:worker_threads', () => ({ parentPort: port2 }));
  await import('./brick-worker.ts');
  const thread = Object.assign(port1, { terminate: async () => port1.close() });
  const threads = new BrickThreads(1, () => thread as unknown as Worker);
  for (const error of [
    new InvalidArgumentError('set', 'It has no splats.'),
    new SplatFileError('damaged', 'a.bricks', 'It is damaged.', { byte: 7 }),
  ]) {
    vi.mocked(runBrickTask).mockRejectedValueOnce(error);
    const arrived = await threads.run(task()).catch((reason) => reason);
    expect(arrived).toBeInstanceOf(error.constructor);
    expect({ ...arrived, message: arrived.message }).toEqual({ ...error, message: error.message });
  }
  await threads.end();
});
