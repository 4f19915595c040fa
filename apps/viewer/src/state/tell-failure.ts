import type { FailureReport } from './messages.ts';
import type { ViewerStore } from './store.ts';

/** Shows why something that a person asked for has failed. The console has particulars of our own mistakes. */
export function tellFailure(
  store: ViewerStore,
  error: unknown,
  report: Omit<FailureReport, 'message'>,
): void {
  if (report.isFault) console.error(error);
  const message = error instanceof Error ? error.message : String(error);
  store.setState({ failure: { ...report, message } });
}
