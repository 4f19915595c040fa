import { afterEach, describe, expect, test } from 'vitest';
import { SplatFileError } from '../data/errors.ts';
import type { Turns } from '../data/turns.ts';
import { fakeWorker } from '../testing/fake-worker.ts';
import { Remote } from './remote.ts';

/** Reasons for which the turns of `wait` rejected. */
const stopped: unknown[] = [];

const TASKS = {
  halve: async (values: Float32Array, _: Turns, onProgress: (done: number) => void) => {
    for (const i of values.keys()) onProgress(i + 1);
    return { halves: values.map((value) => value / 2) };
  },
  copy: async (values: Float32Array, _: Turns, onProgress: (copy: Float32Array) => void) => {
    const copy = values.slice();
    onProgress(copy);
    return copy.length;
  },
  fail: async (file: string) => {
    throw new SplatFileError('damaged', file, 'It is damaged.', { byte: 7 });
  },
  wait: async (_: null, turns: Turns) => {
    for (;;) await turns.give().catch((reason) => Promise.reject(stopped.push(reason)));
  },
};

const FakeWorker = fakeWorker(() => TASKS);
const failure = ({ message }: Partial<ErrorEvent>) => new Error(`It died: ${message}.`);
const startWorker = () => new FakeWorker() as unknown as Worker;
const startNone = async () => null;

afterEach(() => {
  for (const worker of FakeWorker.started) expect(worker.isTerminated).toBe(true);
  FakeWorker.started = [];
  FakeWorker.behaviour = 'works';
});

describe.each([
  ['another thread', startWorker],
  ['the calling thread, if no other can start,', startNone],
])('a task of %s', (_, start) => {
  const made = () => new Remote<typeof TASKS>(start, { failure, here: async () => TASKS });

  test('tells its progress and resolves with its result', async () => {
    const remote = made();
    const done: number[] = [];
    const input = Float32Array.of(2, 6);
    const { halves } = await remote.call('halve', input, { onProgress: (each) => done.push(each) });
    expect([...halves]).toEqual([1, 3]);
    expect(done).toEqual([1, 2]);
    await remote.end();
  });

  test('rejects with its error, of the same class and with the same fields', async () => {
    const remote = made();
    const error = await remote.call('fail', 'a.ply').catch((reason) => reason);
    expect(error).toBeInstanceOf(SplatFileError);
    expect(error).toMatchObject({ code: 'damaged', file: 'a.ply', place: { byte: 7 } });
    expect(error.message).toBe(new SplatFileError('damaged', 'a.ply', 'It is damaged.', { byte: 7 }).message);
    await remote.end();
  });

  test('ends with its signal, before the next one', async () => {
    const remote = made();
    const ending = new AbortController();
    const waiting = remote.call('wait', null, { signal: ending.signal });
    await new Promise((resolve) => setTimeout(resolve, 20));
    expect(remote.waiting).toBe(1);
    stopped.length = 0;
    ending.abort('enough');
    await expect(waiting).rejects.toBe('enough');
    expect((await remote.call('halve', Float32Array.of(4))).halves).toEqual(Float32Array.of(2));
    expect(stopped).toHaveLength(1);
    expect(remote.waiting).toBe(0);
    await remote.end();
  });

  test('rejects at the end of the thread, and so do later ones', async () => {
    const remote = made();
    const waiting = remote.call('wait', null, { signal: new AbortController().signal });
    void remote.end('closed');
    await expect(waiting).rejects.toBe('closed');
    await expect(remote.call('fail', 'a.ply')).rejects.toBe('closed');
    expect(remote.hasEnded).toBe(true);
  });
});

test('the memory of progress is transferred', async () => {
  const remote = new Remote<typeof TASKS>(startWorker, { failure });
  const copies: Float32Array[] = [];
  const input = Float32Array.of(2, 6);
  const leftCount = await remote.call('copy', input, { onProgress: (copy) => copies.push(copy) });
  expect(copies).toEqual([input]);
  // A buffer without bytes: the task has no copy of its own any more.
  expect(leftCount).toBe(0);
  await remote.end();
});

test('a thread that dies rejects its calls, and later ones', async () => {
  FakeWorker.behaviour = 'dies';
  const remote = new Remote<typeof TASKS>(startWorker, { failure });
  await expect(remote.call('fail', 'a.ply')).rejects.toThrow('It died: out of memory.');
  await expect(remote.call('fail', 'a.ply')).rejects.toThrow('It died: out of memory.');
});
