import os from 'node:os';
import { timeSpread } from '@websplatter/core/measure';
import type { Wait } from '../page/completion.ts';
import type { PageState } from '../page/protocol.ts';

/** Facts of a run, in every report. */
export interface RunFacts {
  readonly date: string;
  /** The command line that was called. */
  readonly command: string;
  readonly commit: string | null;
  readonly machine: string;
  /** Name and version; or the program that drew instead of one. */
  readonly browser: string;
  readonly adapter: string | null;
}

/** Facts of a run in a browser. */
export interface RunReport extends RunFacts {
  /** How the end of WebGPU's work was awaited. */
  readonly wait: Wait;
  readonly frames: number;
}

/** This machine, in words. */
export function machineText(): string {
  const cpus = os.cpus();
  const memoryGiB = Math.round(os.totalmem() / 2 ** 30);
  return `${cpus.length} × ${cpus[0]?.model ?? 'unknown'}, ${memoryGiB} GiB; ${os.type()} ${os.release()}; Node ${process.versions.node}`;
}

/** The command, and the machine that ran it. */
export function reportFacts({ date, commit, command, adapter, browser, machine }: RunFacts): string[] {
  return [
    `${date}, commit ${commit ?? 'unknown'}: ${command}`,
    `${adapter ?? 'no adapter'}; ${browser}; ${machine}`,
  ];
}

/** Notes on a peer: each failure and each complaint of its pages once. */
export function problemNotes({ peer, rounds, failures }: MeasuredRow): string[] {
  const complaints = rounds.flatMap(({ state }) => state.problems);
  return [
    ...new Set(failures.map((failure) => `${peer} FAILED: ${failure}`)),
    ...new Set(complaints.map((problem) => `${peer} complains: ${problem}`)),
  ];
}

interface MeasuredRow extends InRounds<{ readonly state: PageState }> {
  readonly peer: string;
  readonly failures: readonly string[];
}

export const NONE = '–';

/** A table of a report. */
export interface ReportPart {
  readonly heading: string;
  /** Cells, the heading first; words in the first two columns. */
  readonly rows: readonly (readonly string[])[];
  readonly notes: readonly string[];
}

/** Null for no values. */
export function spreadOf(values: readonly number[]) {
  return values.length > 0 ? timeSpread(values) : null;
}

export function medianCell(values: readonly number[], digits = 0): string {
  return spreadOf(values)?.median.toFixed(digits) ?? NONE;
}

export function spreadCell(values: readonly number[], digits: number): string {
  const spread = spreadOf(values);
  return spread ? `${spread.median.toFixed(digits)} / ${spread.p99.toFixed(digits)}` : NONE;
}

/** Something measured in rounds, some of which may be missing. */
interface InRounds<Each> {
  readonly rounds: readonly Each[];
}

/** Median and range of the ratio of times, over the rounds in which both peers were measured. */
export function ratioCell<Each extends { readonly round: number }>(
  row: InRounds<Each>,
  base: InRounds<Each>,
  roundMs: (round: Each) => number,
): string {
  const ratios = row.rounds.flatMap((own) => {
    const other = base.rounds.find(({ round }) => round === own.round);
    return other ? [roundMs(own) / roundMs(other)] : [];
  });
  if (ratios.length === 0) return NONE;
  const [middle, least, most] = [spreadOf(ratios)!.median, Math.min(...ratios), Math.max(...ratios)];
  return `${middle.toFixed(2)} (${least.toFixed(2)}–${most.toFixed(2)})`;
}

export function psnrCell(values: readonly number[]): string {
  const spread = spreadOf(values);
  return spread ? `${spread.median.toFixed(1)} (${Math.min(...values).toFixed(1)})` : NONE;
}

/** @param wordColumns how many columns at the left hold words; the others hold figures. */
export function markdownTable(rows: readonly (readonly string[])[], wordColumns: number): string[] {
  const isWord = (column: number) => column < wordColumns;
  const widths = rows[0].map((_, column) => Math.max(...rows.map((row) => row[column].length), 3));
  const line = (cells: readonly string[]) => `| ${cells.join(' | ')} |`;
  const padded = rows.map((row) =>
    line(
      row.map((cell, column) =>
        isWord(column) ? cell.padEnd(widths[column]) : cell.padStart(widths[column]),
      ),
    ),
  );
  const rule = line(
    widths.map((width, column) => (isWord(column) ? '-'.repeat(width) : `${'-'.repeat(width - 1)}:`)),
  );
  return [padded[0], rule, ...padded.slice(1)];
}
