/** The error for a worker that failed or cannot start; browsers do not always give a text. */
export function workerFailure({ message }: Partial<ErrorEvent>): Error {
  return new Error(message || 'The worker could not be started, or had no memory.');
}
