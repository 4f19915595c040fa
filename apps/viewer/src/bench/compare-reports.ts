import { InvalidArgumentError } from '@websplatter/core';
import { type BenchReport, benchFacts, timeCells, timeRows } from './bench-report.ts';

/** Facts that reports must share for their times to be compared. */
const SHARED_FACTS: readonly string[] = ['Scene', 'Path', 'Accuracy'];

/**
 * Reads a report that was saved.
 *
 * @param name of the file, for errors.
 * @throws InvalidArgumentError if it is none.
 */
export function readBenchReport(text: string, name: string): BenchReport {
  try {
    const report: BenchReport = JSON.parse(text);
    // What can be shown is a report.
    benchFacts(report);
    for (const { spread } of timeRows(report.measurement)) timeCells(spread);
    return report;
  } catch {
    const message = `${name} is no report of this benchmark. Choose a file that its button “Save JSON” has written.`;
    throw new InvalidArgumentError('report', message);
  }
}

/** What two reports measured differently, by name: their times cannot be compared then. */
export function differencesOf(report: BenchReport, other: BenchReport): string[] {
  const others = new Map(benchFacts(other));
  return benchFacts(report)
    .filter(([name, value]) => SHARED_FACTS.includes(name) && others.get(name) !== value)
    .map(([name]) => name);
}

/** Median times of a row in several reports; null where a report does not know it. */
export interface ComparedRow {
  readonly name: string;
  readonly mediansMs: readonly (number | null)[];
}

/** The rows of the first report, with the medians of all. */
export function comparedRows(reports: readonly BenchReport[]): ComparedRow[] {
  const [first] = reports;
  const rows = reports.map(({ measurement }) => timeRows(measurement));
  return timeRows(first.measurement).map(({ name }) => ({
    name,
    mediansMs: rows.map((each) => each.find((row) => row.name === name)?.spread.median ?? null),
  }));
}

/** `12.346 ms, × 2.10`: a median, and how many times that of the first report it is. */
export function comparedCell(medianMs: number | null, firstMs: number | null): string {
  if (medianMs === null) return '–';
  const isComparable = firstMs !== null && firstMs > 0 && medianMs !== firstMs;
  return `${medianMs.toFixed(3)}${isComparable ? ` (×\u00a0${(medianMs / firstMs).toFixed(2)})` : ''}`;
}
