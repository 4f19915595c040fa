import { expect, test } from 'vitest';
import { randomSplats } from '../../../testing/random-splats.ts';
import { type BrickResult, type BrickTask, runTask } from './brick-tasks.ts';
import { BrickWriter } from './brick-writer.ts';
import { sliceOf } from './slice-set.ts';

const SET = randomSplats({ count: 4500, seed: 3, shDegree: 1 });
const KINDS = ['records', 'count', 'divide', 'splats', 'blobs'] as const;

/** Writes SET with another `run` for tasks of one kind. */
async function writeWith(
  kind: BrickTask['kind'],
  change: (result: BrickResult, task: BrickTask) => unknown,
): Promise<void> {
  const run = async (task: BrickTask) => {
    const result = await runTask(task);
    return (task.kind === kind ? change(result, task) : result) as BrickResult;
  };
  const writer = new BrickWriter({ run, bucketSplats: 2048 });
  try {
    for (const [from, to] of [
      [0, 2500],
      [2500, SET.count],
    ])
      await writer.add(sliceOf(SET, from, to));
    await writer.finish(async () => {});
  } finally {
    await writer.end();
  }
}

/**
 * @fault Arguments: a `run` of a `BrickWriter` resolves with nothing, with another value than its task's
 *   result, or with the result of another task
 * @consequence `InvalidArgumentError` that shows the value; the writing ends
 */
test.each<[string, (result: BrickResult, task: BrickTask) => unknown]>([
  ['nothing', () => undefined],
  ['null', () => null],
  ['a text', () => 'done'],
  ['an empty object', () => ({})],
  ['what runBrickTask resolves with', (result) => ({ result, buffers: [] })],
  ['members of another class', (result) => ({ ...result, words: [], errors: [] })],
])('a run that resolves with %s is refused by name', async (_, change) => {
  for (const kind of KINDS)
    await expect(writeWith(kind, change), kind).rejects.toMatchObject({
      name: 'InvalidArgumentError',
      argument: 'run',
      message: expect.stringContaining(`for a task of kind ${kind}`),
    });
});

test.each(['records', 'splats'] as const)('results of other tasks are refused: %s', async (kind) => {
  let first: BrickResult | undefined;
  const writing = writeWith(kind, (result) => {
    first ??= result;
    return first;
  });
  await expect(writing).rejects.toMatchObject({ argument: 'run' });
});

test('a run that throws, and arguments that are none, are told', async () => {
  const failing = new BrickWriter({
    run: () => {
      throw new Error('no thread');
    },
  });
  const adding = failing.add(SET).then(() => failing.finish(async () => {}));
  await expect(adding).rejects.toThrow('no thread');
  await failing.end();
  const writer = new BrickWriter({ journal: { entries: (async () => []) as never, note: async () => {} } });
  await expect(writer.resume()).rejects.toMatchObject({ argument: 'journal.entries' });
  await writer.add(SET);
  await expect(writer.keep(-1)).rejects.toMatchObject({ argument: 'rows' });
  await expect(writer.finish(null as never)).rejects.toMatchObject({ argument: 'put' });
  await expect(writer.finish(async () => {}, 1 as never)).rejects.toMatchObject({ argument: 'onProgress' });
  await writer.end();
});
