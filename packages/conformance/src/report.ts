import { COMPARED_PRESETS } from './run-images.ts';
import { CASE_RASTERIZERS, type HardCaseResult } from './run-result.ts';

/** The program and the version of WebSplatter that run hard cases. */
export interface ReportPlace {
  /** Provider of WebGPU: a browser's user agent, or `Node 20.20.2`. */
  readonly program: string;
  /** Version of `@websplatter/core`. */
  readonly version: string;
  /** Commit of the working copy that was run, null if unknown. */
  readonly commit: string | null;
}

/** Results of some hard cases, with the adapter, program and commit that gave them. */
export interface HardCaseReport extends ReportPlace {
  readonly adapter: string;
  readonly isSoftware: boolean;
  /** Whether the GPU blends halves by truncation. */
  readonly isTruncating: boolean;
  /** Features of the device. */
  readonly features: readonly string[];
  /** ISO 8601. */
  readonly date: string;
  /** Width and height of images for cases that give no size. */
  readonly sizePx: number;
  /** Cases that there are. */
  readonly casesInAll: number;
  /** Cases that were to run. */
  readonly casesChosen: number;
  /** Of the cases that ran: fewer than were chosen if the run was stopped. */
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

/** One line: cases passed, duration, GPU, image size, date and commit. */
export function summaryLine(report: HardCaseReport): string {
  const { adapter, date, commit, sizePx, results } = report;
  const places = [adapter, `${sizePx}×${sizePx}`, date, ...(commit === null ? [] : [`commit ${commit}`])];
  return `${passedLine(report)} in ${secondsOf(results).toFixed(1)} s (${places.join(', ')})`;
}

/** Formats a short report to paste: where cases ran, how many passed, worst figures, failures. */
export function textReport(report: HardCaseReport): string {
  const { adapter, isSoftware, isTruncating, features, program, version, commit, date, sizePx, results } =
    report;
  const failures = failureLines(results);
  const lines = [
    ['adapter', `${adapter}${isSoftware ? ', software' : ''}`],
    ['program', program],
    ['version', commit === null ? version : `${version}, commit ${commit}`],
    ['date', date],
    ['images', `${sizePx}×${sizePx}`],
    ['features', features.join(' ') || 'none'],
    ['halves', isTruncating ? 'blended by truncation' : 'blended to the nearest'],
    ...IMAGES.map((image) => [image.heading, worstImage(results, image)]),
    ['stages', worstStage(results)],
    ['time', `${secondsOf(results).toFixed(1)} s`],
  ];
  const width = Math.max(...lines.map(([name]) => name.length));
  return [
    `WebSplatter: ${passedLine(report)}`,
    ...lines.map(([name, value]) => `${name.padEnd(width)}  ${value}`),
    ...(failures.length > 0 ? ['', ...failures] : []),
    '',
  ].join('\n');
}

/** How many passed, and whether that is all that there are. */
function passedLine({ results, casesChosen, casesInAll }: HardCaseReport): string {
  const passed = results.filter(({ verdict }) => verdict === 'pass').length;
  const left = casesChosen - results.length;
  const notes = [
    ...(casesChosen < casesInAll ? [`${casesInAll} in all`] : []),
    ...(left > 0 ? [`stopped before ${left} more`] : []),
  ];
  const cases = casesChosen < casesInAll ? 'chosen hard cases' : 'hard cases';
  const note = notes.length > 0 ? ` (${notes.join(', ')})` : '';
  return `${passed} of ${results.length} ${cases}${note} pass`;
}

function worstImage(
  results: readonly HardCaseResult[],
  { rasterizer, preset }: (typeof IMAGES)[number],
): string {
  const images = results.flatMap(({ name, images }) => {
    const psnrDb = images[rasterizer][preset]?.psnrDb;
    return psnrDb === undefined ? [] : [{ name, psnrDb }];
  });
  if (images.length === 0) return '–';
  const { name, psnrDb } = images.reduce((worst, each) => (each.psnrDb < worst.psnrDb ? each : worst));
  return `${decibels(psnrDb)} at worst (${name})`;
}

function worstStage(results: readonly HardCaseResult[]): string {
  const stages = results.flatMap(({ name, worstStage: stage }) => (stage ? [{ name, stage }] : []));
  if (stages.length === 0) return '–';
  const { name, stage } = stages.reduce((worst, each) =>
    each.stage.ratio > worst.stage.ratio ? each : worst,
  );
  return `${stage.field} ${stage.ratio.toFixed(2)} of its bound at worst (${name})`;
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

function secondsOf(results: readonly HardCaseResult[]): number {
  return results.reduce((sum, { elapsedMs }) => sum + elapsedMs, 0) / 1000;
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
