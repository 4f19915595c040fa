import { onTestFinished, vi } from 'vitest';

/** The errors that are reported as uncaught ones from now on, until the test ends. */
export function reportedErrors(): unknown[] {
  const reported: unknown[] = [];
  vi.stubGlobal('reportError', (error: unknown) => reported.push(error));
  onTestFinished(() => void vi.unstubAllGlobals());
  return reported;
}
