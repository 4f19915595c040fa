import type { CloudStream, StreamReport } from '@websplatter/core';
import { expect, test, vi } from 'vitest';
import { SplatsStreamError } from '../errors.ts';
import { splatDataAt } from '../testing/test-clouds.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';

/** A stream whose report a test changes, and an object that shows its scene. */
function streamed() {
  const listeners = new Set<() => void>();
  let report = { isComplete: false, error: null } as StreamReport;
  const stream = {
    report: () => report,
    subscribe: (listener: () => void) => {
      listeners.add(listener);
      return () => void listeners.delete(listener);
    },
    retry: vi.fn(),
  } as unknown as CloudStream;
  const change = (changed: Partial<StreamReport>) => {
    report = { ...report, ...changed };
    for (const listener of listeners) listener();
  };
  const object = new SplatCloudObject(splatDataAt([0, 0, 0]));
  const events: string[] = [];
  for (const type of ['firstframe', 'complete', 'needsframe'] as const)
    object.addEventListener(type, () => events.push(type));
  const draw = async () => {
    object.announceDrawn(0, [], stream);
    await Promise.resolve();
    return events.splice(0);
  };
  return { stream, object, change, draw, events, listeners };
}

test('a scene is complete each time that a frame shows all after one that did not', async () => {
  const { change, draw, events } = streamed();
  expect(await draw()).toEqual(['firstframe']);
  expect(await draw()).toEqual([]);
  change({ isComplete: true });
  await Promise.resolve();
  // It is not drawn yet.
  expect(events.splice(0)).toEqual(['needsframe']);
  expect(await draw()).toEqual(['complete']);
  change({});
  expect(await draw()).toEqual([]);
  change({ isComplete: false });
  change({ isComplete: true });
  expect(await draw()).toEqual(['needsframe', 'complete']);
});

test('a scene that was loaded whole is complete with its first frame', async () => {
  const object = new SplatCloudObject(splatDataAt([0, 0, 0]));
  const onComplete = vi.fn();
  object.addEventListener('complete', onComplete);
  for (let i = 0; i < 2; i++) {
    object.announceDrawn(0, []);
    await Promise.resolve();
  }
  expect(onComplete).toHaveBeenCalledOnce();
});

test('parts that cannot be fetched are told each time, with a way to go on', async () => {
  const { stream, object, change, draw } = streamed();
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
  // Before the first frame.
  change({ error: new Error('the server is gone') });
  await draw();
  expect(warn).toHaveBeenCalledOnce();
  for (let i = 0; i < 2; i++) change({});
  await Promise.resolve();
  expect(warn).toHaveBeenCalledOnce();
  const onError = vi.fn();
  object.onError = onError;
  change({ error: null });
  change({ error: new Error('the server is gone') });
  await Promise.resolve();
  expect(onError).toHaveBeenCalledOnce();
  const [error] = onError.mock.lastCall as [SplatsStreamError];
  expect(error).toBeInstanceOf(SplatsStreamError);
  expect(error.message).toMatch(/the server is gone/);
  error.retry();
  expect(stream.retry).toHaveBeenCalledOnce();
  warn.mockRestore();
});

test('a scene is followed until others take its place, or it leaves the screen', async () => {
  const { object, draw, listeners } = streamed();
  await draw();
  await draw();
  expect(listeners.size).toBe(1);
  object.dispose();
  expect(listeners.size).toBe(0);
  await draw();
  object.data = splatDataAt([1, 0, 0]);
  expect(listeners.size).toBe(1);
  object.announceDrawn(0, []);
  expect(listeners.size).toBe(0);
});
