import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import os from 'node:os';
import { join } from 'node:path';
import { BenchError } from './bench-error.ts';

/** The command line that was called. */
export interface CommandLine {
  /** Before the arguments. */
  readonly name: string;
  readonly args: readonly string[];
  /** Behind the name, for `--help`. */
  readonly usage: string;
}

interface Surroundings {
  /** Goes away when the command ends. */
  readonly workFolder: string;
  readonly say: (line: string) => void;
}

/** What a bench has found. */
export interface Outcome {
  /** Everything that was measured. */
  readonly report: object;
  /** The report for people. */
  readonly text: string;
  readonly jsonFile: string | null;
  readonly hasFailures: boolean;
}

/** Runs a command of the bench and prints its report, if any; returns the process's exit status. */
export async function runCommand(
  { name, args, usage }: CommandLine,
  work: (surroundings: Surroundings) => Promise<Outcome | null>,
): Promise<number> {
  const help = `${name} ${usage}`;
  if (args.includes('--help')) {
    console.log(help);
    return 0;
  }
  const workFolder = await mkdtemp(join(os.tmpdir(), 'websplatter-bench-'));
  const say = (line: string) => console.error(line);
  try {
    const outcome = await work({ workFolder, say });
    if (!outcome) return 0;
    const { report, text, jsonFile, hasFailures } = outcome;
    console.log(text);
    if (jsonFile) await writeFile(jsonFile, `${JSON.stringify(report, null, 2)}\n`);
    return hasFailures ? 1 : 0;
  } catch (error) {
    if (!(error instanceof BenchError)) throw error;
    say(`${error.message}\n${help}`);
    return 2;
  } finally {
    await rm(workFolder, { recursive: true, force: true });
  }
}
