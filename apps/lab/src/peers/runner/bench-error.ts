/** The bench cannot use the command line, or a file that it names: a message for the caller. */
export class BenchError extends Error {
  override readonly name = 'BenchError';
}
