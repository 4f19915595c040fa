import { alignedColumns, frameFacts, passTable, timeNotes, timeTable } from '@websplatter/charts';
import { type Detail, printable, type ShDegree } from '@websplatter/core';
import type { FrameMeasurement } from '@websplatter/core/measure';
import type { LoadTimes } from './bench-scene.ts';
import type { FoundCamera } from './choose-camera.ts';
import { detailText } from './detail.ts';
import type { describeMachine } from './machine.ts';

/** Everything that one run of `websplatter bench` found. */
export interface BenchReport {
  readonly scene: string;
  /** Whether code makes the splats, in the time that is counted as reading. */
  readonly isMade: boolean;
  /** Degree that is stored: bands that cannot be seen are not. */
  readonly shDegree: ShDegree;
  /** The settings as the user wrote them. */
  readonly accuracyLabel: string;
  readonly detail: Detail;
  /** The camera that was found; absent for a camera of a file. */
  readonly camera?: FoundCamera;
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
  const { passes, copyBytesPerSecond } = measurement;
  const { cpu, cpuCount, memoryGiB, system, node } = machine;
  const { image, visible, memory, copies } = frameFacts(report, measurement);
  const detail = detailText(report.detail, measurement.visibleSplats.median, measurement.loadedSplats);
  const splats = measurement.loadedSplats.toLocaleString('en');
  return [
    `${printable(report.scene)}: ${splats} splats, spherical harmonics of degree ${report.shDegree}`,
    `${measurement.adapter}; ${cpuCount} × ${cpu}, ${memoryGiB} GiB; ${system}; Node ${node}`,
    `commit ${report.commit ?? 'unknown'}`,
    '',
    ...alignedColumns(
      [
        ['image', image],
        ...(report.camera ? [['camera', JSON.stringify(report.camera)]] : []),
        ['loading', loadText(report)],
        ['visible', visible],
        ...(detail === null ? [] : [['detail', detail]]),
        ['GPU memory', memory],
        ['copies', copies],
      ],
      2,
    ),
    '',
    ...alignedColumns(timeTable(measurement), 1),
    '',
    ...(passes ? [...alignedColumns(passTable(passes, copyBytesPerSecond), 2), ''] : []),
    ...timeNotes(measurement),
    '',
  ].join('\n');
}

function loadText({ isMade, load: { readMs, packMs, uploadMs } }: BenchReport): string {
  const total = readMs + packMs + uploadMs;
  const [read, pack, upload, whole] = [readMs, packMs, uploadMs, total].map((ms) => `${ms.toFixed(0)} ms`);
  return `${whole}: ${isMade ? 'making and reading' : 'reading'} ${read}, packing ${pack}, uploading ${upload}`;
}
