import { afterEach, expect, test, vi } from 'vitest';
import { runCommand } from './bench.ts';
import { BenchError } from './bench-error.ts';

const USAGE = '--scenes FILE';

afterEach(() => vi.restoreAllMocks());

test('--help prints the options and does nothing', async () => {
  const print = vi.spyOn(console, 'log').mockReturnValue();
  const work = vi.fn();
  expect(await runCommand({ name: 'bench', args: ['--help'], usage: USAGE }, work)).toBe(0);
  expect(print).toHaveBeenCalledExactlyOnceWith(`bench ${USAGE}`);
  expect(work).not.toHaveBeenCalled();
});

test('mistakes of the command line are told in front of the options, other errors are thrown', async () => {
  const say = vi.spyOn(console, 'error').mockReturnValue();
  const commandLine = { name: 'bench', args: [], usage: USAGE };
  const status = await runCommand(commandLine, () => Promise.reject(new BenchError('No scene.')));
  expect(status).toBe(2);
  expect(say).toHaveBeenCalledExactlyOnceWith(`No scene.\nbench ${USAGE}`);
  await expect(runCommand(commandLine, () => Promise.reject(new Error('lost')))).rejects.toThrow('lost');
});
