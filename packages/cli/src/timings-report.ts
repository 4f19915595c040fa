import { timeSpread } from '@websplatter/core/measure';
import { currentCommit, describeMachine } from './machine.ts';
import type { RenderOptions } from './render-options.ts';
import type { Rendered } from './rendered.ts';

const STAGES = ['preprocessMs', 'sortMs', 'rasterizeMs', 'totalMs', 'wallClockMs'] as const;

/** Contents of the file that `--timings` writes. */
export function timingsReport(options: RenderOptions, rendered: Rendered) {
  const { timings, splatsPerScene } = rendered;
  const { accuracy } = options;
  const { alphaCutoff, sortKeyBits, extent, culling, resolutionScale } = accuracy;
  return {
    source: timings[0]?.source ?? null,
    /** Milliseconds; null for a stage that was not measured by itself. */
    stages: Object.fromEntries(STAGES.map((stage) => [stage, spreadOf(timings.map((each) => each[stage]))])),
    /** Both times are medians of rasterising, or of whole frames without timestamps. */
    rasterizer: rendered.rasterizer,
    frames: options.frames,
    warmUpFrames: rendered.warmUpFrames,
    measuredFrames: timings.length,
    framesIdentical: rendered.firstDifference === null,
    scenes: options.scenes.map((name, i) => ({ name, splats: splatsPerScene[i] })),
    visibleSplats: rendered.visibleSplats,
    widthPx: options.widthPx,
    heightPx: options.heightPx,
    detail: options.detail,
    renderer: options.renderer,
    adapter: rendered.label,
    accuracy:
      options.renderer === 'reference'
        ? { alphaCutoff, sortKeyBits, extent, culling, resolutionScale }
        : { label: options.accuracyLabel, ...accuracy },
    notices: rendered.notices,
    commit: currentCommit(),
    machine: describeMachine(),
  };
}

function spreadOf(timesMs: readonly number[]) {
  const measuredMs = timesMs.filter((timeMs) => !Number.isNaN(timeMs));
  if (measuredMs.length === 0) return null;
  const { median, p99 } = timeSpread(measuredMs);
  return { median, p99 };
}
