import type { Reporter, SerializedError, TestCase, TestModule, TestRunEndReason, Vitest } from 'vitest/node';
import { NO_TIME } from './src/patience.ts';

/**
 * Ends a run with the line `N passed, N failed, N skipped`, for scripts. Failures outside of tests
 * count too: a file that fails to load, a suite's hook, an unhandled rejection, an interrupted run.
 */
export default class PlainLineReporter implements Reporter {
  private isWatching = false;
  private line = '';

  onInit(vitest: Vitest): void {
    this.isWatching = vitest.config.watch;
    if (this.isWatching) return;
    // Other reporters print after onTestRunEnd, and so does Vitest while it closes.
    process.once('exit', () => console.log(this.line || plainLine({ passed: 0, failed: 1, skipped: 0 })));
  }

  onTestRunEnd(
    testModules: readonly TestModule[],
    unhandledErrors: readonly SerializedError[],
    reason: TestRunEndReason,
  ): void {
    const counts = { passed: 0, failed: unhandledErrors.length, skipped: 0 };
    const late = new Map<string, number>();
    for (const testModule of testModules) {
      for (const test of testModule.children.allTests()) {
        if (!isAskedFor(test)) continue;
        const result = test.result();
        const { state } = result;
        if (state === 'skipped' && result.note === NO_TIME)
          late.set(testModule.relativeModuleId, (late.get(testModule.relativeModuleId) ?? 0) + 1);
        counts[state === 'pending' ? 'skipped' : state]++;
      }
      const containers = [testModule, ...testModule.children.allSuites()];
      counts.failed += containers.filter((container) => container.errors().length > 0).length;
    }
    for (const [path, count] of late)
      console.log(`${path}: ${count} tests were skipped: ${NO_TIME} on this machine.`);
    if (reason !== 'passed' && counts.failed === 0) counts.failed = 1;
    this.line = plainLine(counts);
    if (this.isWatching) console.log(this.line);
  }
}

/** Whether the test counts: a project that filters by tags does not run tests without its tags. */
function isAskedFor({ project, tags }: TestCase): boolean {
  const { tagsFilter = [] } = project.serializedConfig;
  return tagsFilter.every((tag) => tags.includes(tag));
}

function plainLine({ passed, failed, skipped }: { passed: number; failed: number; skipped: number }): string {
  return `${passed} passed, ${failed} failed, ${skipped} skipped`;
}
