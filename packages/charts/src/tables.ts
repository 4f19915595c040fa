import type {
  CountSpread,
  FrameMeasurement,
  FrameSpread,
  PassCost,
  TimeSpread,
} from '@websplatter/core/measure';

/** The measured frames and their contents, in words. */
export function frameFacts(
  { orbitDegrees, accuracyLabel }: { readonly orbitDegrees: number; readonly accuracyLabel: string },
  measurement: FrameMeasurement,
): { readonly image: string; readonly visible: string; readonly memory: string; readonly copies: string } {
  const { widthPx, heightPx, frames, rasterizer, memory, copyBytesPerSecond } = measurement;
  const drawn = `drawn by ${rasterizer.rasterizer} (${rasterizer.reason})`;
  return {
    image: `${widthPx}×${heightPx} px, ${accuracyLabel}, ${drawn}; ${frames} frames over ${orbitDegrees}°`,
    visible: visibleText(measurement),
    memory: `${megabytes(memory.totalBytes)} MB, at most ${megabytes(memory.peakBytes)} MB`,
    copies: `${gigabytesPerSecond(copyBytesPerSecond)} GB/s read and written`,
  };
}

function visibleText({ visibleSplats, candidateSplats, tilePairs, loadedSplats }: FrameMeasurement): string {
  const share = (splats: number) => percent(splats / loadedSplats);
  const range = ({ least, most }: CountSpread) => `${share(least)}–${share(most)}`;
  const pairs = tilePairs ? `; ${count(tilePairs.median)} pairs` : '';
  return (
    `${count(visibleSplats.median)} splats, ${share(visibleSplats.median)} (${range(visibleSplats)}); ` +
    `${share(candidateSplats.median)} in visible chunks${pairs}`
  );
}

/** A row of the table of times: a stage, where the GPU tells of stages, or whole frames. */
export interface TimeRow {
  readonly name: string;
  readonly spread: FrameSpread;
  /** Null for whole frames. */
  readonly stage: keyof NonNullable<FrameMeasurement['stageMs']> | null;
}

export function timeRows({ stageMs, gpuMs, wallClockMs }: FrameMeasurement): TimeRow[] {
  const stages: TimeRow[] = stageMs
    ? [
        { name: 'pre-process', spread: stageMs.preprocess, stage: 'preprocess' },
        { name: 'sort', spread: stageMs.sort, stage: 'sort' },
        { name: 'rasterise', spread: stageMs.rasterize, stage: 'rasterize' },
      ]
    : [];
  return [
    ...stages,
    ...(gpuMs ? [{ name: 'whole, GPU', spread: gpuMs, stage: null }] : []),
    { name: 'whole, wall clock', spread: wallClockMs, stage: null },
  ];
}

/** Times as cells, the heading first; one column of words. */
export function timeTable(measurement: FrameMeasurement): string[][] {
  const rows = timeRows(measurement).map(({ name, spread, stage }) => [
    name,
    ...timeCells(spread),
    stage ? '' : (spread.p99 / spread.median).toFixed(2),
    stage ? '' : percent(spread.standardDeviation / spread.median),
  ]);
  return [['frame', 'median ms', 'P99', 'P99/median', 'deviation'], ...rows];
}

/** Passes as cells, the heading first; two columns of words. */
export function passTable(passes: readonly PassCost[], copyBytesPerSecond: number): string[][] {
  const rows = passes.map(({ part, stage, dispatches, timeMs, bytes, bytesPerSecond }, i) => [
    part === passes[i - 1]?.part ? '' : part,
    stage,
    String(dispatches),
    ...timeCells(timeMs),
    bytes ? megabytes(bytes.read) : '–',
    bytes ? megabytes(bytes.written) : '–',
    bytesPerSecond === null ? '–' : gigabytesPerSecond(bytesPerSecond),
    bytesPerSecond === null ? '–' : percent(bytesPerSecond / copyBytesPerSecond),
  ]);
  return [['part', 'pass', '×', 'median ms', 'P99', 'MB read', 'written', 'GB/s', 'of copies'], ...rows];
}

/** Sentences on how the times came about. */
export function timeNotes({ timing, passes, notes }: FrameMeasurement): string[] {
  return [
    timing === 'gpu-timestamps'
      ? 'Times are GPU timestamps, but for the wall clock’s, which runs from submission to completion.'
      : 'This device has no timestamps: only the wall clock from submission to completion is known, and no stage or pass.',
    ...(passes
      ? [
          'Stages are parts of undivided frames. Passes are timed by themselves in further frames; the GPU pauses in between,',
          'so their sum is more. MB are the least that a pass must read and write; “of copies” is GB/s as a share of the rate of copies.',
        ]
      : []),
    ...notes.map((note) => `note: ${note}`),
  ];
}

/** Thousandths, since some passes take a few of them. */
function timeCells({ median, p99 }: TimeSpread): string[] {
  return [median, p99].map((ms) => ms.toFixed(3));
}

function count(value: number): string {
  return Math.round(value).toLocaleString('en');
}

function megabytes(bytes: number): string {
  return (bytes / 1e6).toFixed(2);
}

function gigabytesPerSecond(bytesPerSecond: number): string {
  const rate = bytesPerSecond / 1e9;
  return rate.toFixed(rate < 10 ? 2 : 0);
}

function percent(share: number): string {
  return `${(100 * share).toFixed(1)} %`;
}

/** Joins rows to lines, in columns: the first `leftAligned` to the left, others to the right. */
export function alignedColumns(rows: readonly (readonly string[])[], leftAligned: number): string[] {
  const widths = rows[0].map((_, column) => Math.max(...rows.map((row) => row[column].length)));
  return rows.map((row) =>
    row
      .map((cell, column) =>
        column < leftAligned ? cell.padEnd(widths[column]) : cell.padStart(widths[column]),
      )
      .join('  ')
      .trimEnd(),
  );
}
