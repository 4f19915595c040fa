/** The error for a worker that failed or cannot start; browsers do not always give a text. */
export function workerFailure({ message }: Partial<ErrorEvent>): Error {
  return new Error(
    message || 'A background thread could not start, or ran out of memory. Close other pages and try again.',
  );
}
