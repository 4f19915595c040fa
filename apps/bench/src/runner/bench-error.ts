/** The command line, or a file that it names, is not what the bench takes: its message is for whoever called it. */
export class BenchError extends Error {
  override readonly name = 'BenchError';
}
