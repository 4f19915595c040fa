import type { AccuracySettings } from '@websplatter/core';
import type { FrameMeasurement, FrameSpread } from '@websplatter/core/measure';
import { formatCount } from '../formatting/format.ts';
import type { BrowserMachine } from './machine.ts';

/** Everything that one benchmark found. */
export interface BenchReport {
  /** Of WebSplatter. */
  readonly version: string;
  /** Of the working copy; null outside of git. */
  readonly commit: string | null;
  /** ISO 8601. */
  readonly madeAt: string;
  readonly machine: BrowserMachine;
  readonly scene: {
    readonly title: string;
    readonly clouds: number;
    readonly splats: number;
    /** Degree of harmonics that is stored, the highest of any cloud. */
    readonly shDegree: number;
  };
  /** Angle that the camera covered. */
  readonly sweepDegrees: number;
  /** Settings that were asked for; `measurement.settings` are those that the device drew with. */
  readonly accuracy: AccuracySettings;
  /** From asking for the scene until the GPU had it. */
  readonly loadMs: number;
  readonly measurement: FrameMeasurement;
  /** Sentences about what to keep in mind. */
  readonly notes: readonly string[];
}

/** A row of the table of times. */
export interface TimeRow {
  readonly name: string;
  readonly spread: FrameSpread;
  /** The stage that it is, if it is one. */
  readonly stage?: 'preprocess' | 'sort' | 'rasterize';
}

const STAGES = [
  ['preprocess', 'Pre-process'],
  ['sort', 'Sort'],
  ['rasterize', 'Rasterize'],
] as const;

/** The stages, where the GPU has told of them, and whole frames. */
export function timeRows({ stageMs, gpuMs, wallClockMs }: FrameMeasurement): TimeRow[] {
  const stages = stageMs ? STAGES.map(([stage, name]) => ({ name, stage, spread: stageMs[stage] })) : [];
  return [
    ...stages,
    ...(gpuMs ? [{ name: 'Whole frame, GPU', spread: gpuMs }] : []),
    { name: 'Whole frame, wall clock', spread: wallClockMs },
  ];
}

export function benchJson(report: BenchReport): string {
  return `${JSON.stringify(report, null, 2)}\n`;
}

/** The name of the file that a report is saved as, without what file systems refuse. */
export function benchFileName({ measurement, scene, madeAt }: BenchReport): string {
  const parts = ['websplatter-bench', scene.title, measurement.adapter, madeAt.slice(0, 10)];
  return `${parts.join(' ').replaceAll(/[^\p{L}\p{N}]+/gu, '-')}.json`;
}

/** A short report for people, in Markdown. */
export function benchText(report: BenchReport): string {
  const rows = timeRows(report.measurement).map(({ name, spread }) => [name, ...timeCells(spread)]);
  const line = (cells: readonly string[]) => `| ${cells.join(' | ')} |`;
  return [
    ...benchFacts(report).map(([name, value]) => `- ${name}: ${value}`),
    '',
    line(['', ...TIME_HEADINGS]),
    line(['---', ...TIME_HEADINGS.map(() => '---:')]),
    ...rows.map(line),
    ...(report.notes.length > 0 ? ['', ...report.notes.map((note) => `Note: ${note}`)] : []),
    '',
  ].join('\n');
}

export const TIME_HEADINGS = ['median ms', 'P99 ms', 'deviation ms'] as const;

/** Median, P99 and standard deviation. */
export function timeCells({ median, p99, standardDeviation }: FrameSpread): string[] {
  return [median, p99, standardDeviation].map((ms) => ms.toFixed(3));
}

/** What was measured, where and how, by name. */
export function benchFacts(report: BenchReport): [name: string, value: string][] {
  const { machine, scene, measurement, sweepDegrees, loadMs, version, commit } = report;
  const { widthPx, heightPx, frames, rasterizer, visibleSplats, memory, copyBytesPerSecond } = measurement;
  const computer = [
    machine.platform,
    machine.architecture,
    machine.model,
    machine.threads && `${machine.threads} threads`,
    machine.memoryGiB && `${machine.memoryGiB} GiB or more`,
  ].filter(Boolean);
  return [
    ['Scene', `${scene.title}, ${formatCount(scene.splats)} splats, harmonics of degree ${scene.shDegree}`],
    ['Path', `${frames} frames over ${sweepDegrees}°, ${widthPx}×${heightPx} px`],
    ['Accuracy', settingsText(measurement.settings)],
    ['Drawn by', `${rasterizer.rasterizer} (${rasterizer.reason})`],
    ['Visible', `${formatCount(visibleSplats.median)} splats in the median`],
    ['Adapter', measurement.adapter],
    ['Browser', machine.browser],
    ['Machine', computer.join(', ') || 'The browser tells nothing'],
    ['GPU memory', `${(memory.peakBytes / 1e6).toFixed(1)} MB at most`],
    ['Copies', `${(copyBytesPerSecond / 1e9).toFixed(1)} GB/s read and written`],
    ['Loading', `${loadMs.toFixed(0)} ms`],
    ['Version', commit === null ? version : `${version}, commit ${commit}`],
    ['Date', report.madeAt],
  ];
}

/** All settings by name, so that two reports can be compared word by word. */
function settingsText(settings: AccuracySettings): string {
  return Object.entries(settings)
    .map(([name, value]) => `${name} ${value}`)
    .join(', ');
}
