import { COMPARED_PRESETS } from './run-images.ts';
import { CASE_RASTERIZERS, type HardCaseResult } from './run-result.ts';

/** Results of some hard cases, with the adapter and commit that gave them. */
export interface HardCaseReport {
  readonly adapter: string;
  /** ISO 8601. */
  readonly date: string;
  /** Commit of the working copy that was run, null if unknown. */
  readonly commit: string | null;
  /** Width and height of images for cases that give no size. */
  readonly sizePx: number;
  readonly results: readonly HardCaseResult[];
}

/** All presets of the first rasteriser, and the one that every case bounds of the others. */
const IMAGES = CASE_RASTERIZERS.flatMap((rasterizer, i) =>
  COMPARED_PRESETS.filter((preset) => i === 0 || preset === 'reference').map((preset) => ({
    rasterizer,
    preset,
    heading: `${rasterizer}, ${preset} dB`,
  })),
);
const COLUMNS = [
  'case',
  'worst stage error (of its bound)',
  ...IMAGES.map(({ heading }) => heading),
  'max error',
  'verdict',
];
/** Widths of the columns after the first. */
const COLUMN_WIDTHS = [34, ...IMAGES.map(({ heading }) => heading.length), 9, 7];

/** Formats the heading of `resultLine`s, for names of up to `nameWidth` characters. */
export function resultHeading(nameWidth: number): string {
  return alignedLine(COLUMNS, nameWidth);
}

/** Formats one result as a line of a table. */
export function resultLine(result: HardCaseResult, nameWidth: number): string {
  return alignedLine(cellsOf(result), nameWidth);
}

/** Lists all failures, one per line. */
export function failureLines(results: readonly HardCaseResult[]): string[] {
  return results.flatMap(({ failures }) => failures);
}

/** Sums up how many cases passed, where, when and in what time. */
export function summaryLine({ adapter, date, commit, sizePx, results }: HardCaseReport): string {
  const passed = results.filter(({ verdict }) => verdict === 'pass').length;
  const seconds = results.reduce((sum, { elapsedMs }) => sum + elapsedMs, 0) / 1000;
  const places = [adapter, `${sizePx}×${sizePx}`, date, ...(commit === null ? [] : [`commit ${commit}`])];
  return `${passed} of ${results.length} hard cases pass in ${seconds.toFixed(1)} s (${places.join(', ')})`;
}

/** Formats the report as a Markdown table. */
export function markdownReport(report: HardCaseReport): string {
  const row = (cells: readonly string[]) =>
    `| ${cells.map((cell) => cell.replaceAll('|', '\\|')).join(' | ')} |`;
  const lines = [
    `${summaryLine(report)}.`,
    '',
    row(['group', ...COLUMNS]),
    row(['group', ...COLUMNS].map(() => '---')),
    ...report.results.map((result) => row([result.group, ...cellsOf(result)])),
  ];
  const failures = failureLines(report.results);
  if (failures.length > 0) lines.push('', 'Failures:', '', ...failures.map((failure) => `- ${failure}`));
  return `${lines.join('\n')}\n`;
}

/** Formats the report as JSON. Infinities and NaNs, which JSON lacks, become text. */
export function jsonReport(report: HardCaseReport): string {
  const asText = (_: string, value: unknown) =>
    typeof value === 'number' && !Number.isFinite(value) ? String(value) : value;
  return `${JSON.stringify(report, asText, 2)}\n`;
}

function cellsOf({ name, worstStage, images, verdict }: HardCaseResult): string[] {
  const stage = worstStage
    ? `${worstStage.field} ${scientific(worstStage.error)} (${worstStage.ratio.toFixed(2)})`
    : '–';
  const maxErrors = CASE_RASTERIZERS.map((rasterizer) => images[rasterizer].reference?.maxError);
  const known = maxErrors.filter((error) => error !== undefined);
  const maxError = known.length > 0 ? scientific(Math.max(...known)) : '–';
  return [
    name,
    stage,
    ...IMAGES.map(({ rasterizer, preset }) => decibels(images[rasterizer][preset]?.psnrDb)),
    maxError,
    verdict,
  ];
}

function decibels(psnrDb: number | undefined): string {
  if (psnrDb === undefined) return '–';
  return Number.isFinite(psnrDb) ? psnrDb.toFixed(1) : 'exact';
}

function scientific(value: number): string {
  return value === 0 ? '0' : value.toExponential(1);
}

function alignedLine([name, ...cells]: readonly string[], nameWidth: number): string {
  return [name.padEnd(nameWidth), ...cells.map((cell, i) => cell.padEnd(COLUMN_WIDTHS[i]))]
    .join('  ')
    .trimEnd();
}
