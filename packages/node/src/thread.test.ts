import { Worker } from 'node:worker_threads';
import { expect, test } from 'vitest';
import { Thread } from './thread.ts';

/** A thread that runs a body for each message, `ask`. */
function threadOf(body: string): Thread<unknown, unknown> {
  const program = `const { parentPort } = require('node:worker_threads'); parentPort.on('message', (ask) => { ${body} });`;
  return new Thread(
    'test',
    new Worker(program, { eval: true, resourceLimits: { maxOldGenerationSizeMb: 16 } }),
  );
}

test('a thread answers one question after the other', async () => {
  const thread = threadOf('parentPort.postMessage(ask + 1)');
  expect([await thread.ask(1), await thread.ask(2)]).toEqual([2, 3]);
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
    await expect(thread.ask(question)).rejects.toMatchObject({
      code: 'worker-failed',
      message: expect.stringContaining(message),
    });
});

test('a thread that ends while nobody asks fails the next question', async () => {
  const worker = new Worker('setTimeout(() => { throw new Error("broken"); })', { eval: true });
  const thread = new Thread('test', worker);
  await new Promise((resolve) => worker.once('exit', resolve));
  await expect(thread.ask(1)).rejects.toThrow('broken');
});
