import { Worker } from 'node:worker_threads';
import { Remote } from '@websplatter/core/write';
import { expect, test } from 'vitest';
import { threadPort } from './thread.ts';

type TestTasks = { readonly ask: (question: number) => number };

function remoteOf(worker: Worker): Remote<TestTasks> {
  return new Remote(() => threadPort('test', worker), { failure: ({ error }) => error });
}

/** A thread that runs a body for each question, `ask`. */
function threadOf(body: string): Remote<TestTasks> {
  const program = `const { parentPort } = require('node:worker_threads');
    parentPort.on('message', ({ id, input: ask }) => { ${body} });`;
  return remoteOf(new Worker(program, { eval: true, resourceLimits: { maxOldGenerationSizeMb: 16 } }));
}

test('a thread answers one question after the other', async () => {
  const thread = threadOf("parentPort.postMessage({ kind: 'done', id, result: ask + 1 })");
  expect([await thread.call('ask', 1), await thread.call('ask', 2)]).toEqual([2, 3]);
  await thread.end();
});

/**
 * @fault Command line: a thread that makes bricks, or draws a reference, dies: no memory, an error, an
 *   exit
 * @consequence its task and all waiting tasks fail: one line, exit status 2, no file
 */
test.each([
  ['ends itself', 'process.exit(3)', 'test: a thread stopped: it ended with status 3.'],
  ['throws', 'throw new Error("broken")', 'test: a thread stopped: broken.'],
  ['has no memory', 'for (const all = []; ; ) all.push(Array(1000).fill(ask))', 'memory limit'],
])('a thread that %s fails its question, and later ones', async (_, body, message) => {
  const thread = threadOf(body);
  for (const question of [1, 2])
    await expect(thread.call('ask', question)).rejects.toMatchObject({
      code: 'worker-failed',
      message: expect.stringContaining(message),
    });
});

test('a thread that ends while nobody asks fails the next question', async () => {
  const worker = new Worker('setTimeout(() => { throw new Error("broken"); })', { eval: true });
  const thread = remoteOf(worker);
  await new Promise((resolve) => worker.once('exit', resolve));
  await expect(thread.call('ask', 1)).rejects.toThrow('broken');
});
