import type { Evidence } from '../../../../docs/src/build/evidence.ts';
import { NONE, type ReportPart, type RunFacts, type RunReport } from './report.ts';

interface Asked {
  readonly jsonFile: string | null;
  readonly evidenceFile: string | null;
}

/**
 * The files of a run that the options ask for: everything that was measured, and its tables as
 * evidence for the documentation.
 *
 * @param legend meaning of the columns
 */
export function filesOf(
  { jsonFile, evidenceFile }: Asked,
  report: RunReport,
  parts: readonly ReportPart[],
  legend: readonly string[],
): ReadonlyMap<string, object> {
  const files = new Map<string, object>();
  if (jsonFile !== null) files.set(jsonFile, report);
  if (evidenceFile !== null) files.set(evidenceFile, evidenceOf(report, parts, legend));
  return files;
}

/** A run as evidence. Its conclusion is for people to draw. */
export function evidenceOf(
  { date, command, commit, machine, browser, adapter }: RunFacts,
  parts: readonly ReportPart[],
  legend: readonly string[],
): Evidence {
  return {
    title: `${command.split(' ').slice(0, 3).join(' ')}, ${date.slice(0, 10)}`,
    conclusion: 'No conclusion has been drawn yet.',
    run: {
      ...(commit !== null && { commit }),
      date: date.slice(0, 10),
      machine,
      ...(adapter !== null && { adapter }),
      browser,
      command,
    },
    tables: parts.map(({ heading, rows: [columns, ...rows] }) => ({
      caption: heading,
      columns,
      rows: rows.map((row) => row.map(measuredValue)),
    })),
    remarks: [...parts.flatMap(({ notes }) => notes), ...legend],
  };
}

/** A cell as evidence has it: numbers that lose nothing by it, and null for none. */
function measuredValue(cell: string): string | number | null {
  if (cell === NONE) return null;
  return String(Number(cell)) === cell && Number.isFinite(Number(cell)) ? Number(cell) : cell;
}
