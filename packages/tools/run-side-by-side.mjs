import { stripVTControlCharacters } from 'node:util';
import { runTool } from './run-tool.mjs';

/** Where Vitest begins to sum up a run. */
const SUMMARY = /^[\s⎯]*(?:Failed (?:Suites|Tests) \d+|Unhandled (?:Errors|Rejection))[\s⎯]*$|^ *Test Files /;
/** The last line of a run, from `plain-line-reporter.ts`. */
const COUNTS = /^(\d+) passed, (\d+) failed, (\d+) skipped$/;

/**
 * Runs Vitest once for each list of projects, all at the same time. The files of one list then share one process, with
 * modules that are imported once and shaders that Dawn compiles once. Prints what they print as one run does: summaries
 * and failures come at the end, and one line counts all tests.
 *
 * @param {string} vitest Path of Vitest's script.
 * @param {{ cwd: string, env: NodeJS.ProcessEnv }} options
 * @param {readonly (readonly string[])[]} lists Names of projects.
 * @returns {Promise<number>} The exit status: 0 where all runs succeeded.
 */
export async function runSideBySide(vitest, { cwd, env }, lists) {
  const isColoured = process.stdout.isTTY && env.NO_COLOR === undefined;
  const runs = await Promise.all(
    lists.map(async (projects) => {
      const summary = [];
      let counts = null;
      const takeLine = (line) => {
        const plain = stripVTControlCharacters(line);
        const found = COUNTS.exec(plain);
        if (found) counts = found.slice(1).map(Number);
        else if (summary.length > 0 || SUMMARY.test(plain)) summary.push(line);
        else console.log(line);
      };
      const args = ['run', ...projects.flatMap((project) => ['--project', project])];
      const childEnv = isColoured ? { FORCE_COLOR: '1', ...env } : env;
      const { status } = await runTool(vitest, args, { cwd, env: childEnv }, takeLine);
      // A run that was cut off has failed, also if its process says that it has not.
      return counts
        ? { status: status ?? 1, summary, counts }
        : { status: status || 1, summary, counts: [0, 1, 0] };
    }),
  );
  for (const { summary } of runs) for (const line of summary) console.log(line);
  const [passed, failed, skipped] = [0, 1, 2].map((i) =>
    runs.reduce((sum, { counts }) => sum + counts[i], 0),
  );
  console.log(`${passed} passed, ${failed} failed, ${skipped} skipped`);
  return Math.max(...runs.map(({ status }) => status));
}
