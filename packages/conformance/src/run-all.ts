import { HARD_CASES } from './catalogue.ts';
import type { HardCase } from './hard-case.ts';
import type { HardCaseReport, ReportPlace } from './report.ts';
import { HardCaseRunner, type HardCaseRunnerOptions, type HardCaseRunOptions } from './run.ts';
import type { HardCaseResult } from './run-result.ts';

/** Width and height of images for cases that give no size. */
export const DEFAULT_SIZE_PX = 64;

export interface HardCasesOptions extends HardCaseRunnerOptions, Omit<HardCaseRunOptions, 'mutation'> {
  readonly cases: readonly HardCase[];
  /** Place where the cases run, for the report. */
  readonly place: ReportPlace;
  /** Called after each case, in order. */
  readonly onResult?: (result: HardCaseResult) => void;
  /** Ends the run before the next case; the report then has the cases that were run. */
  readonly signal?: AbortSignal;
}

/**
 * Runs hard cases one by one on one GPU, in browsers, Node and Deno alike, and reports on them.
 *
 * @throws WebGpuUnavailableError if there is no adapter or no device.
 */
export async function runHardCases({
  cases,
  place,
  onResult,
  signal,
  gpu,
  renderReference,
  ...options
}: HardCasesOptions): Promise<HardCaseReport> {
  const { sizePx = DEFAULT_SIZE_PX } = options;
  const runner = await HardCaseRunner.create({ gpu, renderReference });
  const results: HardCaseResult[] = [];
  try {
    for (const hardCase of cases) {
      if (signal?.aborted) break;
      const result = await runner.run(hardCase, { ...options, sizePx });
      results.push(result);
      onResult?.(result);
    }
    const { adapterLabel: adapter, isSoftware, isTruncating, features } = runner;
    const date = new Date().toISOString().slice(0, 10);
    const casesInAll = HARD_CASES.length;
    const casesChosen = cases.length;
    return {
      ...place,
      adapter,
      isSoftware,
      isTruncating,
      features,
      date,
      sizePx,
      casesInAll,
      casesChosen,
      results,
    };
  } finally {
    runner.destroy();
  }
}
