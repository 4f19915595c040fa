import { ACCURACY_PRESETS } from '@websplatter/core';
import type { FrameMeasurement } from '@websplatter/core/measure';
import type { BenchReport } from './bench-report.ts';

const spread = (median: number) => ({
  median,
  low: median,
  high: median,
  p99: 2 * median,
  standardDeviation: median / 10,
});
const count = { least: 1, median: 2, most: 3 };

/** A report like those of devices that have timestamps. */
export function benchReport(changes: Partial<FrameMeasurement> = {}): BenchReport {
  return {
    version: '0.1.0',
    commit: 'abc',
    madeAt: '2026-01-02T03:04:05.678Z',
    machine: {
      browser: 'Browser/1',
      platform: 'Linux 6.1',
      architecture: null,
      model: null,
      threads: 8,
      memoryGiB: null,
    },
    scene: { title: 'A scene/1', clouds: 1, splats: 12_345, shDegree: 3 },
    sweepDegrees: 15,
    accuracy: ACCURACY_PRESETS.balanced,
    loadMs: 120.4,
    measurement: {
      adapter: 'vendor x1',
      settings: ACCURACY_PRESETS.balanced,
      rasterizer: { rasterizer: 'tiles', reason: 'a reason' },
      widthPx: 640,
      heightPx: 360,
      frames: 20,
      loadedSplats: 12_345,
      candidateSplats: count,
      visibleSplats: count,
      tilePairs: count,
      timing: 'gpu-timestamps',
      gpuMs: spread(4),
      wallClockMs: spread(5),
      stageMs: { preprocess: spread(1), sort: spread(0.5), rasterize: spread(2) },
      passes: null,
      copyBytesPerSecond: 4e11,
      memory: { totalBytes: 1e6, peakBytes: 2e6, resources: [] },
      notes: [],
      ...changes,
    },
    notes: [],
  };
}
