import { alignedColumns } from '@websplatter/charts';
import type { AccuracyPoint, AccuracyTable, TimeSpread } from '@websplatter/core/measure';
import type { AccuracyOptions } from './accuracy-options.ts';
import type { FoundCamera } from './choose-camera.ts';

type Column = readonly [heading: string, cell: (point: AccuracyPoint, table: AccuracyTable) => string];

const COLUMNS: readonly Column[] = [
  ['', (point, table) => `${point.isOnFront ? '*' : ' '}${isBase(point, table) ? '>' : ' '}`],
  ['setting', ({ name }) => name],
  ['splats', ({ splats }) => splats.toLocaleString('en')],
  ['PSNR dB', ({ error }) => decibels(error.psnrDb)],
  ['filtered dB', ({ filteredPsnrDb }) => (filteredPsnrDb === null ? '–' : decibels(filteredPsnrDb))],
  ['max error', ({ error }) => eightBit(error.maxError)],
  ['99.9 %', ({ error }) => eightBit(error.p999Error)],
  ['SSIM', ({ error }) => error.ssim.toFixed(5)],
  ['pre-process', ({ timeMs }) => milliseconds(timeMs.preprocess)],
  ['sort', ({ timeMs }) => milliseconds(timeMs.sort)],
  ['rasterise', ({ timeMs }) => milliseconds(timeMs.rasterize)],
  ['drawn by', ({ rasterizers }) => rasterizers.join(', ')],
  ['total ms', ({ timeMs }) => milliseconds(timeMs.total)],
  ['interval', ({ timeMs: { total } }) => `${total.low.toFixed(2)}–${total.high.toFixed(2)}`],
  ['P99', ({ timeMs }) => timeMs.total.p99.toFixed(2)],
  ['MB', ({ bytes }) => (bytes / 1e6).toFixed(1)],
];
/** Columns of text; the others, of numbers, are right-aligned. */
const LEFT_ALIGNED = 2;

/** Fewer frames give no interval of 95 % confidence: it spans all measured times instead. */
const INTERVAL_FRAMES = 6;

/** Whether the intervals of a table with so many frames hold the median with 95 % confidence. */
export function isInterval(frames: number): boolean {
  return frames >= INTERVAL_FRAMES;
}

/** Whether a point shows less detail than the settings that are compared. */
export function isOfLessDetail({ detail }: AccuracyPoint, table: AccuracyTable): boolean {
  return detail !== table.detail;
}

/** Whether a point is the one whose settings and detail are changed in the others. */
export function isBase(point: AccuracyPoint, table: AccuracyTable): boolean {
  return point.settings === table.base && !isOfLessDetail(point, table);
}

/** Formats the table as text, fastest first. */
export function accuracyText(table: AccuracyTable, scene: string): string {
  const points = [...table.points].sort((a, b) => a.timeMs.total.median - b.timeMs.total.median);
  const rows = [
    COLUMNS.map(([heading]) => heading),
    ...points.map((point) => COLUMNS.map(([, cell]) => cell(point, table))),
  ];
  const lines = alignedColumns(rows, LEFT_ALIGNED);
  const { widthPx, heightPx, splats, adapter, frames, views, timing, elapsedMs } = table;
  const notes = [
    ...table.reference.notes.map((note) => `reference: ${note}`),
    ...points.flatMap(({ name, notes: own }) => own.map((note) => `${name}: ${note}`)),
    ...table.notes,
  ];
  const measured = `${frames} frames each${views > 1 ? ` from ${views} cameras, the worst of which counts` : ''}`;
  return [
    `${scene}: ${splats.toLocaleString('en')} splats, ${widthPx}×${heightPx} px, ${adapter}`,
    '',
    ...lines,
    '',
    '> the base   * on the front: nothing measured is both more accurate and faster',
    'Errors are against the reference; maximum and 99.9th percentile in steps of 8 bits.',
    ...(points.some(({ filteredPsnrDb }) => filteredPsnrDb !== null)
      ? ['Filtered is against the reference with 4×4 samples per pixel: what the eye should see.']
      : []),
    `Times are medians of ${measured}, by ${timing === 'gpu-timestamps' ? 'GPU timestamps' : 'the wall clock'}; the interval ${isInterval(frames) ? 'holds the median with 95 %' : 'is all that was measured'}.`,
    `Measured in ${(elapsedMs / 1000).toFixed(1)} s.`,
    ...[...new Set(notes)].map((note) => `note: ${note}`),
    '',
  ].join('\n');
}

/**
 * Formats all measurements as JSON; `psnrDb` is null where the image equals the reference.
 *
 * @param camera the camera that was found; null if it came from a file.
 */
export function accuracyJson(
  table: AccuracyTable,
  { scenes, distance }: Pick<AccuracyOptions, 'scenes' | 'distance'>,
  camera: FoundCamera | null,
): string {
  const finite = (_key: string, value: unknown) => (value === Number.POSITIVE_INFINITY ? null : value);
  return `${JSON.stringify({ scenes, distance, ...(camera && { camera }), ...table }, finite, 2)}\n`;
}

function decibels(psnrDb: number): string {
  return psnrDb === Number.POSITIVE_INFINITY ? 'equal' : psnrDb.toFixed(1);
}

function eightBit(error: number): string {
  return (255 * error).toFixed(error < 0.1 / 255 ? 3 : 1);
}

function milliseconds(spread: TimeSpread | null): string {
  return spread === null ? '–' : spread.median.toFixed(2);
}
