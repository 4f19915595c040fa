import {
  type HardCase,
  type HardCaseReport,
  type HardCaseResult,
  resultHeading,
  resultLine,
  textReport,
} from '@websplatter/conformance';

/** How far a run is, in words. */
export function progressText(results: readonly HardCaseResult[], cases: readonly HardCase[]): string {
  const failed = results.filter(({ verdict }) => verdict === 'fail').length;
  const next = cases[results.length];
  return [
    `${results.length} of ${cases.length} cases`,
    failed > 0 && `${failed} failed`,
    next && `now ${next.name}`,
  ]
    .filter(Boolean)
    .join(' · ');
}

/** The short report, and below it a line for each case. */
export function reportByCase(report: HardCaseReport): string {
  const nameWidth = Math.max(4, ...report.results.map(({ name }) => name.length));
  const lines = report.results.map((result) => resultLine(result, nameWidth));
  return [textReport(report), resultHeading(nameWidth), ...lines, ''].join('\n');
}

/** PSNR of a case with preset `reference`, dB: by quads, then by tiles; `–` without an image. */
export function referenceDecibels({
  images,
}: Pick<HardCaseResult, 'images'>): [quads: string, tiles: string] {
  return [decibels(images.quads.reference?.psnrDb), decibels(images.tiles.reference?.psnrDb)];
}

function decibels(psnrDb: number | undefined): string {
  if (psnrDb === undefined) return '–';
  return Number.isFinite(psnrDb) ? psnrDb.toFixed(1) : 'exact';
}
