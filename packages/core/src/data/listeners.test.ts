import { expect, onTestFinished, test, vi } from 'vitest';
import { reportedErrors } from '../testing/reported-errors.ts';
import { callListener, guarded, Listeners } from './listeners.ts';

const error = new Error('of a listener');
const bad = () => {
  throw error;
};

/**
 * @fault Listeners: any listener or callback throws, or its promise rejects
 * @consequence the error is reported; others are called
 */
test('errors of a listener are reported, and none is thrown', async () => {
  const reported = reportedErrors();
  callListener(bad);
  guarded(bad)!();
  callListener(async () => bad());
  expect(reported).toEqual([error, error]);
  await null;
  await null;
  expect(reported).toEqual([error, error, error]);
});

test('errors are on the console where nothing else takes them', () => {
  const log = vi.spyOn(console, 'error').mockImplementation(() => {});
  onTestFinished(() => log.mockRestore());
  vi.stubGlobal('reportError', undefined);
  onTestFinished(() => void vi.unstubAllGlobals());
  callListener(bad);
  expect(log.mock.calls).toEqual([[error]]);
});

test('no listener is none to call', () => {
  callListener(null);
  callListener(undefined);
  expect(guarded(null)).toBeUndefined();
});

test('listeners are called in order, whatever the others do', () => {
  const reported = reportedErrors();
  const listeners = new Listeners<[string]>();
  const calls: string[] = [];
  listeners.add(bad);
  listeners.add((word) => {
    calls.push(`first ${word}`);
    stopThird();
    // Called from the next time on.
    if (word === 'a') listeners.add((later) => calls.push(`fourth ${later}`));
  });
  const second = (word: string) => calls.push(`second ${word}`);
  listeners.add(second);
  const stopAgain = listeners.add(second);
  const stopThird = listeners.add(() => calls.push('third'));
  listeners.call('a');
  expect(calls.splice(0)).toEqual(['first a', 'second a', 'second a']);
  stopAgain();
  stopAgain();
  listeners.call('b');
  expect(calls.splice(0)).toEqual(['first b', 'second b', 'fourth b']);
  expect(reported).toEqual([error, error]);
  expect(listeners.size).toBe(4);
  listeners.clear();
  listeners.call('c');
  expect(calls).toEqual([]);
});
