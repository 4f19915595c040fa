import { printable, WebSplatterError } from '@websplatter/core';
import { accuracy } from './accuracy.ts';
import { bench } from './bench.ts';
import type { Console } from './console.ts';
import { convert } from './convert.ts';
import { hardcases } from './hardcases.ts';
import { info } from './info.ts';
import { describeSystemError, ReaderLeftError, UsageError } from './input-error.ts';
import { version } from './machine.ts';
import { render } from './render.ts';
import { soak } from './soak.ts';
import { split } from './split.ts';
import { USAGE } from './usage.ts';

/** A command: does its work or throws. */
type Command = (args: readonly string[], console: Console) => Promise<void>;

const COMMANDS: Readonly<Record<string, Command>> = {
  render,
  info,
  convert,
  split,
  accuracy,
  bench,
  hardcases,
  soak,
};

/** Codes of errors that the input did not cause. */
const FAILURE_CODES = new Set([
  'webgpu-unavailable',
  'destroyed',
  'frames-differ',
  'gpu-error',
  'non-finite-image',
  'hard-cases-failed',
  'soak-failed',
]);

/** Runs one command line and returns its exit status: 0, 2 on bad input, 1 on any other failure. */
export async function main(args: readonly string[], console: Console): Promise<number> {
  try {
    await dispatch(args, console);
    return 0;
  } catch (error) {
    // Its reader knows.
    if (error instanceof ReaderLeftError) return 1;
    console.err(`${oneLine(error)}\n`);
    if (process.env.WEBSPLATTER_DEBUG === '1' && error instanceof Error) console.err(`${error.stack}\n`);
    return error instanceof WebSplatterError && !FAILURE_CODES.has(error.code) ? 2 : 1;
  }
}

/** Runs `args` with this process's own streams, then ends the process. */
export async function run(args: readonly string[]): Promise<never> {
  for (const stream of [process.stdout, process.stderr]) stream.on('error', endUnlessReaderLeft);
  const status = await main(args, {
    out: (text) => process.stdout.write(text),
    err: (text) => process.stderr.write(text),
  });
  for (const stream of [process.stdout, process.stderr]) {
    await new Promise<void>((resolve) => stream.write('', () => resolve()));
  }
  // Dawn's threads can keep an idle process from ending.
  process.exit(status);
}

/** Ends the process if its output cannot be written. A reader that has left (`head`) has seen enough: the work goes on. */
function endUnlessReaderLeft(error: NodeJS.ErrnoException): void {
  if (error.code === 'EPIPE') return;
  console.error(`websplatter: cannot write: ${describeSystemError(error)}`);
  process.exit(1);
}

async function dispatch([name, ...args]: readonly string[], console: Console): Promise<void> {
  if (name === undefined) throw new UsageError('command', 'no command');
  if (name === '--version') return console.out(`${version}\n`);
  if (name === '--help' || name === '-h' || args.includes('--help') || args.includes('-h'))
    return console.out(USAGE);
  if (!Object.hasOwn(COMMANDS, name)) throw new UsageError('command', `there is no command ${name}`);
  await COMMANDS[name](args, console);
}

function oneLine(error: unknown): string {
  const message = error instanceof Error ? error.message : String(error);
  const text = printable(message.replace(/\s+/g, ' ').trim());
  const isExpected = error instanceof WebSplatterError;
  return `websplatter: ${isExpected ? text : `failed: ${text} (WEBSPLATTER_DEBUG=1 shows where)`}`;
}
