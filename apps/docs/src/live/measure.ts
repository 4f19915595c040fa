// Part of the kit: measurements on the reader's GPU, in the viewer's terms.
import { isSoftwareAdapter, perspectiveCamera, type SplatCloud, SplatEngine } from '@websplatter/core';
import {
  type AccuracyTable,
  type FrameMeasurement,
  measureAccuracy,
  measureFrames,
  orbitCameras,
} from '@websplatter/core/measure';
import { stillLifeCameras } from '@websplatter/scenes';
import type { Measured } from './measured.ts';

export interface MeasureHereOptions {
  readonly signal: AbortSignal;
  readonly onProgress: (progress: {
    readonly done: number;
    readonly total: number;
    readonly label: string;
  }) => void;
}

/** Measured frames: a software rasterizer takes as long for a frame as a GPU for a hundred. */
const FRAMES = { gpu: 120, software: 4 };
const ACCURACY_FRAMES = { gpu: 15, software: 3 };
/** Files of the kit, in this module's folder. */
const SCENE = { gpu: 'still-life.sog', software: 'still-life-small.spz' };
const SIZE_PX = { gpu: [1280, 720], software: [256, 144] } as const;
const SWEEP_DEGREES = 60;

/**
 * Measures error and time of each preset, for the built-in scene from the front.
 *
 * @throws WebGpuUnavailableError; errors of the measurement; the signal's reason.
 */
export function measureAccuracyHere(options: MeasureHereOptions): Promise<Measured> {
  return withScene(async ({ engine, clouds, camera, widthPx, heightPx, kind }) =>
    accuracyInWords(
      await measureAccuracy(engine, {
        clouds,
        cameras: [camera],
        widthPx,
        heightPx,
        settings: [],
        ablations: false,
        combinations: false,
        frames: ACCURACY_FRAMES[kind],
        ...options,
      }),
      kind,
    ),
  );
}

/**
 * Measures the time of each stage while the camera circles the built-in scene.
 *
 * @throws WebGpuUnavailableError; errors of the measurement; the signal's reason.
 */
export function measurePerformanceHere(options: MeasureHereOptions): Promise<Measured> {
  return withScene(async ({ engine, clouds, camera, widthPx, heightPx, kind }) => {
    const cameras = orbitCameras(camera, clouds[0].cloud.robustBounds, {
      count: FRAMES[kind],
      sweepDegrees: SWEEP_DEGREES,
    });
    return framesInWords(
      await measureFrames(engine, { clouds, cameras, widthPx, heightPx, ...options }),
      kind,
    );
  });
}

async function withScene<Result>(measure: (scene: MeasuredScene) => Promise<Result>): Promise<Result> {
  const engine = await SplatEngine.create();
  try {
    const kind = isSoftwareAdapter(engine.device.adapterInfo) ? 'software' : 'gpu';
    const [widthPx, heightPx] = SIZE_PX[kind];
    const cloud = await engine.load(new URL(SCENE[kind], import.meta.url));
    const camera = perspectiveCamera({ ...stillLifeCameras[0], aspect: widthPx / heightPx });
    return await measure({ engine, clouds: [{ cloud }], camera, widthPx, heightPx, kind });
  } finally {
    engine.destroy();
  }
}

interface MeasuredScene {
  readonly engine: SplatEngine;
  readonly clouds: readonly [{ readonly cloud: SplatCloud }];
  readonly camera: ReturnType<typeof perspectiveCamera>;
  readonly widthPx: number;
  readonly heightPx: number;
  readonly kind: 'gpu' | 'software';
}

export function accuracyInWords(table: AccuracyTable, kind: 'gpu' | 'software'): Measured {
  return {
    facts: [
      table.adapter,
      timingWords(table.timing),
      `${table.widthPx} × ${table.heightPx}`,
      splatWords(table.splats),
      `${table.frames} frames each`,
    ],
    columns: ['Setting', 'PSNR (dB)', 'Time (ms)', 'drawn by', 'Memory (MB)'],
    rows: table.points.map(({ name, error, timeMs, rasterizers, bytes }) => [
      name,
      Number.isFinite(error.psnrDb) ? error.psnrDb.toFixed(1) : 'equal',
      timeMs.total.median.toFixed(2),
      rasterizers.join(' and '),
      (bytes / 1e6).toFixed(1),
    ]),
    notes: [...cautions(kind, table.timing), ...table.notes],
  };
}

export function framesInWords(measured: FrameMeasurement, kind: 'gpu' | 'software'): Measured {
  const { stageMs, gpuMs, wallClockMs } = measured;
  const rows = [
    ...(stageMs
      ? ([
          ['Pre-process', stageMs.preprocess],
          ['Sort', stageMs.sort],
          ['Rasterise', stageMs.rasterize],
        ] as const)
      : []),
    ...(gpuMs ? [['Whole frame, GPU', gpuMs] as const] : []),
    ['Whole frame, wall clock', wallClockMs] as const,
  ];
  return {
    facts: [
      measured.adapter,
      timingWords(measured.timing),
      `${measured.widthPx} × ${measured.heightPx}`,
      splatWords(measured.loadedSplats),
      `${measured.frames} frames over ${SWEEP_DEGREES}°`,
      `drawn by ${measured.rasterizer.rasterizer} (${measured.rasterizer.reason})`,
    ],
    columns: ['Stage', 'median ms', 'P99 ms', 'deviation ms'],
    rows: rows.map(([name, { median, p99, standardDeviation }]) => [
      name,
      ...[median, p99, standardDeviation].map((ms) => ms.toFixed(3)),
    ]),
    notes: [...cautions(kind, measured.timing), ...measured.notes],
  };
}

const timingWords = (source: AccuracyTable['timing']) =>
  source === 'gpu-timestamps' ? 'GPU timestamps' : 'wall clock';

const splatWords = (splats: number) => `${splats.toLocaleString('en')} splats`;

function cautions(kind: 'gpu' | 'software', source: AccuracyTable['timing']): string[] {
  return [
    ...(kind === 'software'
      ? ['Measured on a software adapter: times are those of the CPU, not of a GPU.']
      : []),
    ...(source === 'wall-clock'
      ? ['Times are the wall clock’s, since this GPU does not time its own work.']
      : []),
  ];
}
