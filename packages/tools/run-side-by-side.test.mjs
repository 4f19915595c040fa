import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { afterAll, beforeAll, expect, test, vi } from 'vitest';
import { runSideBySide } from './run-side-by-side.mjs';

let folder;
beforeAll(() => {
  folder = mkdtempSync(join(tmpdir(), 'side-by-side-'));
});
afterAll(() => rmSync(folder, { recursive: true }));

/** Runs a script in place of Vitest for the projects `a` and `b`, and returns its lines and exit status. */
async function runOf(script) {
  const path = join(folder, 'vitest.mjs');
  writeFileSync(path, `const isA = process.argv.includes('a');\n${script}`);
  const lines = [];
  const log = vi.spyOn(console, 'log').mockImplementation((line) => lines.push(line));
  try {
    // Node warns of a NO_COLOR beside a FORCE_COLOR, on a line of its own.
    const { NO_COLOR: _, FORCE_COLOR: __, ...env } = process.env;
    const status = await runSideBySide(path, { cwd: folder, env }, [['a'], ['b']]);
    return { lines, status };
  } finally {
    log.mockRestore();
  }
}

test('summaries come last, and one line counts all tests', async () => {
  const { lines, status } = await runOf(`
    console.log(isA ? 'file of a' : 'file of b');
    console.log(isA ? '\\x1b[31m Failed Tests 1 \\x1b[0m' : '');
    console.log(' Test Files  2');
    console.log(isA ? '3 passed, 1 failed, 0 skipped' : '40 passed, 0 failed, 2 skipped');
    process.exitCode = isA ? 1 : 0;`);
  expect(status).toBe(1);
  expect(lines.slice(0, 3).toSorted()).toEqual(['', 'file of a', 'file of b']);
  expect(lines.slice(3)).toEqual([
    expect.stringContaining('Failed Tests 1'),
    ' Test Files  2',
    ' Test Files  2',
    '43 passed, 1 failed, 2 skipped',
  ]);
});

test('a run that ends without a count of its tests has failed', async () => {
  const { lines, status } = await runOf(
    "if (isA) process.kill(process.pid, 'SIGKILL'); else console.log('5 passed, 0 failed, 0 skipped');",
  );
  expect(status).toBe(1);
  expect(lines).toEqual(['5 passed, 1 failed, 0 skipped']);
  const silent = await runOf("if (!isA) console.log('5 passed, 0 failed, 0 skipped');");
  expect(silent).toEqual({ lines: ['5 passed, 1 failed, 0 skipped'], status: 1 });
});

test('a test may print the words of a summary', async () => {
  const { lines } = await runOf(`
    console.log(isA ? 'Unhandled Errors are none of ours' : 'b');
    console.log(isA ? 'after it' : '5 passed, 0 failed, 0 skipped');
    console.log(isA ? '⎯⎯ Unhandled Errors ⎯⎯' : '');
    if (isA) console.log('3 passed, 0 failed, 0 skipped');`);
  expect(lines.at(-2)).toBe('⎯⎯ Unhandled Errors ⎯⎯');
  expect(lines.slice(0, -2).toSorted()).toEqual(['', 'Unhandled Errors are none of ours', 'after it', 'b']);
});
