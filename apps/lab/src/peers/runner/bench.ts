import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import os from 'node:os';
import { join } from 'node:path';
import { BenchError } from './bench-error.ts';
import type { BuiltPages, BuiltPeer } from './built-pages.ts';
import type { CommonOptions } from './options.ts';
import type { ChosenPeer } from './peer-list.ts';

/** A bench: one kind of measurement. `npm run SCRIPT` runs it. */
interface Kind<Options> {
  /** Name in the root's package.json. */
  readonly script: string;
  /** Behind the command's name. */
  readonly usage: string;
  /** Reads the command line; paths are from `folder`. @throws BenchError */
  readOptions(args: readonly string[], folder: string): Options;
}

/** A bench that runs in Node. */
export interface NodeBench<Options> extends Kind<Options> {
  /** @throws BenchError if a scene cannot be read. */
  measure(options: Options, run: Run): Promise<Outcome>;
}

/** A bench of pages in browsers, which runs in a checkout and from a pack. */
export interface PageBench<Options extends CommonOptions> extends Kind<Options> {
  /** Reads `options.peers`. @throws BenchError */
  choose(options: Options, folder: string): ChosenPeer[];
  /** @throws BenchError if a scene cannot be read. */
  measure(options: Options, peers: readonly BuiltPeer[], setup: BenchSetup): Promise<Outcome>;
}

/** One run of a command. */
interface Run {
  /** Goes away when the command ends. */
  readonly workFolder: string;
  /** Prints a line of progress. */
  readonly say: (line: string) => void;
  /** For the report. */
  readonly commandLine: CommandLine;
}

/** One run of a bench of pages: its pages and browser. */
export interface BenchSetup extends Run {
  /** Chromium's program. */
  readonly executablePath: string;
  readonly pages: BuiltPages;
  readonly pagesFolder: string;
}

/** The command line that was called. */
export interface CommandLine {
  /** Before the arguments. */
  readonly name: string;
  readonly args: readonly string[];
  /** Behind the name, for `--help`. */
  readonly usage: string;
}

/** The result of a bench. */
export interface Outcome {
  /** The report for people. */
  readonly text: string;
  /** Contents of the files that the options ask for, by path. */
  readonly files: ReadonlyMap<string, object>;
  readonly hasFailures: boolean;
}

/** Runs a command and prints the bench's report, if any; returns the process's exit status. */
export async function runCommand(
  commandLine: CommandLine,
  work: (run: Run) => Promise<Outcome | null>,
): Promise<number> {
  const { name, args, usage } = commandLine;
  const help = `${name} ${usage}`;
  if (args.includes('--help')) {
    console.log(help);
    return 0;
  }
  const workFolder = await mkdtemp(join(os.tmpdir(), 'websplatter-bench-'));
  const say = (line: string) => console.error(line);
  try {
    const outcome = await work({ workFolder, say, commandLine });
    if (!outcome) return 0;
    const { text, files, hasFailures } = outcome;
    console.log(text);
    for (const [file, content] of files) await writeFile(file, `${JSON.stringify(content, null, 2)}\n`);
    return hasFailures ? 1 : 0;
  } catch (error) {
    if (!(error instanceof BenchError)) throw error;
    say(`${error.message}\n${help}`);
    return 2;
  } finally {
    await rm(workFolder, { recursive: true, force: true });
  }
}
