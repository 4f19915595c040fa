import { printable, type ShDegree } from '@websplatter/core';
import type {
  CountSpread,
  FrameMeasurement,
  FrameSpread,
  PassCost,
  TimeSpread,
} from '@websplatter/core/measure';
import type { LoadTimes } from './bench-scene.ts';
import type { describeMachine } from './machine.ts';
import { alignedColumns } from './text-table.ts';

/** Everything that one run of `websplatter bench` found. */
export interface BenchReport {
  readonly scene: string;
  /** Whether code makes the splats, in the time that is counted as reading. */
  readonly isMade: boolean;
  /** Degree that is stored: bands that cannot be seen are not. */
  readonly shDegree: ShDegree;
  /** The settings as the user wrote them. */
  readonly accuracyLabel: string;
  readonly orbitDegrees: number;
  readonly load: LoadTimes;
  readonly measurement: FrameMeasurement;
  /** Null outside of git. */
  readonly commit: string | null;
  readonly machine: ReturnType<typeof describeMachine>;
}

export function benchJson(report: BenchReport): string {
  return `${JSON.stringify(report, null, 2)}\n`;
}

/** Formats a report for people. */
export function benchText(report: BenchReport): string {
  const { measurement, machine } = report;
  const { passes, copyBytesPerSecond, notes, timing, memory } = measurement;
  const { cpu, cpuCount, memoryGiB, system, node } = machine;
  const hasTimestamps = timing === 'gpu-timestamps';
  return [
    `${printable(report.scene)}: ${count(measurement.loadedSplats)} splats, spherical harmonics of degree ${report.shDegree}`,
    `${measurement.adapter}; ${cpuCount} × ${cpu}, ${memoryGiB} GiB; ${system}; Node ${node}`,
    `commit ${report.commit ?? 'unknown'}`,
    '',
    ...alignedColumns(
      [
        ['image', imageText(report)],
        ['loading', loadText(report)],
        ['visible', visibleText(measurement)],
        ['GPU memory', `${megabytes(memory.totalBytes)} MB, at most ${megabytes(memory.peakBytes)} MB`],
        ['copies', `${gigabytesPerSecond(copyBytesPerSecond)} GB/s read and written`],
      ],
      2,
    ),
    '',
    ...alignedColumns(
      [['frame', 'median ms', 'P99', 'P99/median', 'deviation'], ...frameRows(measurement)],
      1,
    ),
    '',
    ...(passes ? [...passTable(passes, copyBytesPerSecond), ''] : []),
    hasTimestamps
      ? 'Times are GPU timestamps, but for the wall clock’s, which runs from submission to completion.'
      : 'This device has no timestamps: only the wall clock from submission to completion is known, and no stage or pass.',
    ...(passes
      ? [
          'Stages are parts of undivided frames. Passes are timed by themselves in further frames; the GPU pauses in between,',
          'so their sum is more. MB are the least that a pass must read and write; the share is that of the copies’ rate.',
        ]
      : []),
    ...notes.map((note) => `note: ${note}`),
    '',
  ].join('\n');
}

function imageText({ measurement, accuracyLabel, orbitDegrees }: BenchReport): string {
  const { widthPx, heightPx, frames, rasterizer } = measurement;
  const drawn = `drawn by ${rasterizer.rasterizer} (${rasterizer.reason})`;
  return `${widthPx}×${heightPx} px, ${accuracyLabel}, ${drawn}; ${frames} frames over ${orbitDegrees}°`;
}

function loadText({ isMade, load: { readMs, packMs, uploadMs } }: BenchReport): string {
  const total = readMs + packMs + uploadMs;
  const [read, pack, upload, whole] = [readMs, packMs, uploadMs, total].map((ms) => `${ms.toFixed(0)} ms`);
  return `${whole}: ${isMade ? 'making and reading' : 'reading'} ${read}, packing ${pack}, uploading ${upload}`;
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

function frameRows({ gpuMs, wallClockMs, stageMs }: FrameMeasurement): string[][] {
  const whole = (name: string, spread: FrameSpread) => [
    ...timeCells(name, spread),
    (spread.p99 / spread.median).toFixed(2),
    percent(spread.standardDeviation / spread.median),
  ];
  const stage = (name: string, spread: TimeSpread) => [...timeCells(name, spread), '', ''];
  return [
    ...(stageMs
      ? [
          stage('pre-process', stageMs.preprocess),
          stage('sort', stageMs.sort),
          stage('rasterize', stageMs.rasterize),
        ]
      : []),
    ...(gpuMs ? [whole('whole, GPU', gpuMs)] : []),
    whole('whole, wall clock', wallClockMs),
  ];
}

function timeCells(name: string, { median, p99 }: TimeSpread): string[] {
  return [name, milliseconds(median), milliseconds(p99)];
}

/** Columns of a pass that hold text. */
const TEXT_COLUMNS = 2;

function passTable(passes: readonly PassCost[], copyBytesPerSecond: number): string[] {
  const rows = passes.map(({ part, stage, dispatches, timeMs, bytes, bytesPerSecond }, i) => [
    part === passes[i - 1]?.part ? '' : part,
    stage,
    String(dispatches),
    milliseconds(timeMs.median),
    milliseconds(timeMs.p99),
    bytes ? megabytes(bytes.read) : '–',
    bytes ? megabytes(bytes.written) : '–',
    bytesPerSecond === null ? '–' : gigabytesPerSecond(bytesPerSecond),
    bytesPerSecond === null ? '–' : percent(bytesPerSecond / copyBytesPerSecond),
  ]);
  const heading = ['part', 'pass', '×', 'median ms', 'P99', 'MB read', 'written', 'GB/s', 'of copies'];
  return alignedColumns([heading, ...rows], TEXT_COLUMNS);
}

function count(value: number): string {
  return Math.round(value).toLocaleString('en');
}

/** Thousandths, since some passes take a few of them. */
function milliseconds(ms: number): string {
  return ms.toFixed(3);
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
