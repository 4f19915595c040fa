/** The command line, or a file that it names, is not what the bench takes: its message is for the caller. */
export class BenchError extends Error {
  override readonly name = 'BenchError';
}
