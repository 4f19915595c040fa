import { alignedColumns, frameFacts, passTable, timeNotes, timeRows, timeTable } from '@websplatter/charts';
import { InvalidArgumentError } from '@websplatter/core';
import type { FrameMeasurement } from '@websplatter/core/measure';
import type { BrowserMachine } from './machine.ts';

/** The common part of reports of this page and of `websplatter bench --json`. */
export interface FrameReport {
  readonly scene: string;
  /** Angle that the camera covered. */
  readonly orbitDegrees: number;
  readonly measurement: FrameMeasurement;
}

/** Everything that one benchmark found. */
export interface BenchmarkReport extends FrameReport {
  /** Of WebSplatter. */
  readonly version: string;
  /** Of the working copy; null outside of git. */
  readonly commit: string | null;
  /** ISO 8601. */
  readonly madeAt: string;
  readonly machine: BrowserMachine;
  /** The highest of any cloud. */
  readonly shDegree: number;
  /** The settings as the address has them. */
  readonly accuracyLabel: string;
  /** From asking for the scene until the GPU had it. */
  readonly loadMs: number;
}

/** Subject, place and method of the measurement, by name. */
export function reportFacts(report: BenchmarkReport): [name: string, value: string][] {
  const { machine, scene, measurement, shDegree, loadMs, version, commit } = report;
  const { image, visible, memory, copies } = frameFacts(report, measurement);
  const computer = [
    machine.platform,
    machine.architecture,
    machine.model,
    machine.threads && `${machine.threads} threads`,
    machine.memoryGiB && `${machine.memoryGiB} GiB or more`,
  ].filter(Boolean);
  const splats = measurement.loadedSplats.toLocaleString('en');
  return [
    ['scene', `${scene}, ${splats} splats, spherical harmonics of degree ${shDegree}`],
    ['image', image],
    ['visible', visible],
    ['adapter', measurement.adapter],
    ['browser', machine.browser],
    ['machine', computer.join(', ') || 'not reported by the browser'],
    ['GPU memory', memory],
    ['copies', copies],
    ['loading', `${loadMs.toFixed(0)} ms`],
    ['version', commit === null ? version : `${version}, commit ${commit}`],
    ['date', report.madeAt],
  ];
}

/** The report as text, with the tables of `websplatter bench`. */
export function reportText(report: BenchmarkReport): string {
  const { measurement } = report;
  const { passes, copyBytesPerSecond } = measurement;
  return [
    ...alignedColumns(reportFacts(report), 2),
    '',
    ...alignedColumns(timeTable(measurement), 1),
    '',
    ...(passes ? [...alignedColumns(passTable(passes, copyBytesPerSecond), 2), ''] : []),
    ...timeNotes(measurement),
    '',
  ].join('\n');
}

/**
 * Reads a saved report, of this page or of `websplatter bench --json`.
 *
 * @param name of the file, for errors.
 * @throws InvalidArgumentError if it is none.
 */
export function readReport(text: string, name: string): FrameReport {
  try {
    const report: FrameReport = JSON.parse(text);
    // Anything that can be shown is a report.
    if (pathOf(report).includes('undefined')) throw new RangeError('It has no path.');
    timeTable(report.measurement);
    return report;
  } catch {
    const message = `${name} is not a report of this benchmark. Choose a file written by its button “Save JSON” or by websplatter bench --json.`;
    throw new InvalidArgumentError('report', message);
  }
}

/** Facts in which two reports differ, so that their times cannot be compared. */
export function differencesOf(report: FrameReport, other: FrameReport): string[] {
  const facts = (each: FrameReport) => ({
    scene: each.measurement.loadedSplats,
    path: pathOf(each),
    accuracy: JSON.stringify(each.measurement.settings),
  });
  const others: Record<string, unknown> = facts(other);
  return Object.entries(facts(report)).flatMap(([name, value]) => (others[name] === value ? [] : [name]));
}

function pathOf({ orbitDegrees, measurement: { frames, widthPx, heightPx } }: FrameReport): string {
  return `${frames} frames over ${orbitDegrees}°, ${widthPx}×${heightPx}`;
}

/** Median times of several reports as cells, each beside the first's; a row for each of that. */
export function comparedRows(reports: readonly FrameReport[]): string[][] {
  const rows = reports.map(({ measurement }) => timeRows(measurement));
  return rows[0].map(({ name, spread: first }) => [
    name,
    ...rows.map((own) => {
      const median = own.find((row) => row.name === name)?.spread.median;
      if (median === undefined) return '–';
      const isComparable = first.median > 0 && median !== first.median;
      return `${median.toFixed(3)}${isComparable ? ` (×\u00a0${(median / first.median).toFixed(2)})` : ''}`;
    }),
  ]);
}
