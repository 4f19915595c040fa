import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import type { Reading } from '../state/inspecting.ts';
import { SceneReader } from './scene-reader.ts';

class FakeWorker {
  static last: FakeWorker;
  readonly posted: unknown[] = [];
  isEnded = false;
  onmessage: ((event: { data: object }) => void) | null = null;
  onerror: ((event: { message: string }) => void) | null = null;

  constructor() {
    FakeWorker.last = this;
  }

  postMessage(message: unknown): void {
    this.posted.push(message);
  }

  reply(data: object): void {
    this.onmessage?.({ data });
  }

  terminate(): void {
    this.isEnded = true;
  }
}

beforeEach(() => void vi.stubGlobal('Worker', FakeWorker));
afterEach(() => vi.unstubAllGlobals());

const CLOUDS = [{ source: { kind: 'url', href: 'https://example.org/a.ply' }, modelMatrix: null }] as const;

function readerOf(clouds = async () => CLOUDS) {
  const readings: Reading[] = [];
  return { reader: new SceneReader(clouds, (reading) => readings.push(reading)), readings };
}

it('reads the scene once, then asks; answers find who asked', async () => {
  const { reader, readings } = readerOf();
  const first = reader.ask('histograms', null);
  const second = reader.ask('splat', { cloudIndex: 0, row: 4 });
  await expect.poll(() => FakeWorker.last.posted.length).toBe(1);
  FakeWorker.last.reply({ kind: 'progress', id: 1, progress: 0.5 });
  FakeWorker.last.reply({ kind: 'done', id: 1 });
  await expect.poll(() => FakeWorker.last.posted.length).toBe(3);
  expect(FakeWorker.last.posted).toEqual([
    { task: 'read', id: 1, input: CLOUDS },
    { task: 'ask', id: 2, input: { about: 'histograms', question: null } },
    { task: 'ask', id: 3, input: { about: 'splat', question: { cloudIndex: 0, row: 4 } } },
  ]);
  FakeWorker.last.reply({ kind: 'done', id: 3, result: null });
  expect(await second).toBeNull();
  FakeWorker.last.reply({ kind: 'done', id: 2, result: { kept: 1, total: 2 } });
  expect(await first).toEqual({ kept: 1, total: 2 });
  expect(readings).toEqual([
    { kind: 'running', part: undefined },
    { kind: 'running', part: 0.5 },
    { kind: 'done' },
  ]);
});

it('closing it answers no question, and the next one reads again', async () => {
  const { reader, readings } = readerOf();
  const asked = reader.ask('histograms', null);
  await expect.poll(() => FakeWorker.last.posted.length).toBe(1);
  const before = FakeWorker.last;
  reader.close();
  expect(await asked).toBeUndefined();
  expect(before.isEnded).toBe(true);
  expect(readings.at(-1)).toEqual({ kind: 'none' });
  void reader.ask('histograms', null);
  expect(FakeWorker.last).not.toBe(before);
});

it.each([
  [
    'the file',
    () =>
      FakeWorker.last.reply({ kind: 'error', id: 1, error: { className: 'Error', message: 'It is gone.' } }),
    'It is gone.',
  ],
  ['the worker', () => FakeWorker.last.onerror?.({ message: '' }), 'out of memory'],
])('%s that fails is told, and answers no question', async (_, fail, message) => {
  const { reader, readings } = readerOf();
  const asked = reader.ask('histograms', null);
  await expect.poll(() => FakeWorker.last.posted.length).toBe(1);
  fail();
  expect(await asked).toBeUndefined();
  expect(readings.at(-1)).toEqual({ kind: 'failed', message: expect.stringContaining(message) });
});

it('a scene without sources is told', async () => {
  const { reader, readings } = readerOf(async () => {
    throw new Error('There is no such case.');
  });
  expect(await reader.ask('histograms', null)).toBeUndefined();
  expect(readings.at(-1)).toEqual({ kind: 'failed', message: 'There is no such case.' });
});
