import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import os from 'node:os';
import { join } from 'node:path';
import { BenchError } from './bench-error.ts';
import { type BenchOptions, USAGE } from './options.ts';
import type { Report } from './report.ts';
import { reportText } from './table.ts';

/** The command line that was called. */
export interface CommandLine {
  /** Before the arguments. */
  readonly name: string;
  readonly args: readonly string[];
}

interface Surroundings {
  /** Goes away when the command ends. */
  readonly workFolder: string;
  readonly say: (line: string) => void;
}

interface Outcome {
  readonly options: BenchOptions;
  readonly report: Report;
}

/** Runs a command of the bench and prints its report, if any; returns the process's exit status. */
export async function runCommand(
  { name, args }: CommandLine,
  work: (surroundings: Surroundings) => Promise<Outcome | null>,
): Promise<number> {
  const usage = `${name} ${USAGE}`;
  if (args.includes('--help')) {
    console.log(usage);
    return 0;
  }
  const workFolder = await mkdtemp(join(os.tmpdir(), 'websplatter-bench-'));
  const say = (line: string) => console.error(line);
  try {
    const outcome = await work({ workFolder, say });
    if (!outcome) return 0;
    const { options, report } = outcome;
    console.log(reportText(report));
    if (options.jsonFile) await writeFile(options.jsonFile, `${JSON.stringify(report, null, 2)}\n`);
    return report.scenes.some(({ rows }) => rows.some(({ failures }) => failures.length)) ? 1 : 0;
  } catch (error) {
    if (!(error instanceof BenchError)) throw error;
    say(`${error.message}\n${usage}`);
    return 2;
  } finally {
    await rm(workFolder, { recursive: true, force: true });
  }
}
