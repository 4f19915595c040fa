import type { AccuracySettings, FrameRasterizer } from '../data/accuracy/accuracy.ts';
import { isAccuracyTarget } from '../data/accuracy/accuracy-target.ts';
import type { Camera } from '../data/camera/camera.ts';
import { callListener } from '../data/listeners.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { GpuMemoryReport } from '../gpu/gpu-memory.ts';
import { FrameProfile, type PassTime } from '../gpu/timing/frame-profile.ts';
import type { FrameStatistics } from '../gpu/timing/frame-statistics.ts';
import { checkMeasured } from './check-options.ts';
import { measureCopyBandwidth } from './copy-bandwidth.ts';
import { leastBytes, type PassBytes } from './least-bytes.ts';
import type { MeasureProgress } from './measure-accuracy.ts';
import type { MeasuredEngine, MeasuredView } from './measured-engine.ts';
import { clockNotes, drawMeasured, withView } from './measured-frames.ts';
import { standardDeviation, type TimeSpread, timeSpread } from './time-spread.ts';

/** Scene and repetitions of `measureFrames`. */
export interface MeasureFramesOptions
  extends Pick<FrameRequest, 'clouds' | 'widthPx' | 'heightPx' | 'sortBy' | 'detail'> {
  /** One camera per measured frame, each unlike the one before: see `orbitCameras`. */
  readonly cameras: readonly Camera[];
  /** Default the engine's; under a target, the engine's settings. */
  readonly accuracy?: FrameRequest['accuracy'];
  /** Bytes of each copy that bandwidth is measured by: see `CopyBandwidthOptions`. */
  readonly copyBytes?: number;
  /** Ends the measurement: it rejects with the signal's reason and frees its memory. */
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: MeasureProgress) => void;
}

/** Spread of the times of successive frames, in milliseconds. */
export interface FrameSpread extends TimeSpread {
  readonly standardDeviation: number;
}

/** Cost of one stage of a part of a frame. */
export interface PassCost {
  /** Label of the stage's pass in frames without a profile, e.g. `pre-process`. */
  readonly part: string;
  /** Name of the stage's WGSL file without extension, e.g. `cull-splats`. */
  readonly stage: string;
  /** Dispatches or draws of one frame, the most of all frames. */
  readonly dispatches: number;
  /** Milliseconds per frame of all its dispatches or draws. */
  readonly timeMs: TimeSpread;
  /**
   * Least bytes that the stage must move per frame, median over the frames: see `leastBytes`. Null
   * if unknown.
   */
  readonly bytes: PassBytes | null;
  /**
   * `bytes` divided by the median time, bytes per second; null if unknown, or if the time is too
   * short for the GPU's clock.
   */
  readonly bytesPerSecond: number | null;
}

/** Numbers of something over the measured frames. */
export interface CountSpread {
  readonly least: number;
  readonly median: number;
  readonly most: number;
}

/** Times, bytes and memory of a scene's frames on one device. */
export interface FrameMeasurement {
  readonly adapter: string;
  readonly settings: AccuracySettings;
  readonly rasterizer: { readonly rasterizer: FrameRasterizer; readonly reason: string };
  readonly widthPx: number;
  readonly heightPx: number;
  /** Number of measured frames. */
  readonly frames: number;
  readonly loadedSplats: number;
  /** Splats in the chunks that can reach into the image. */
  readonly candidateSplats: CountSpread;
  readonly visibleSplats: CountSpread;
  /** Pairs of a visible splat and a bin; null where quads draw. */
  readonly tilePairs: CountSpread | null;
  /** The clock of the frames; by the wall clock, only `wallClockMs` is known. */
  readonly timing: FrameStatistics['timing']['source'];
  /** GPU time from the first pass of a frame to the last; null without timestamps. */
  readonly gpuMs: FrameSpread | null;
  /** From submission to completion, by the CPU's clock; frames never overlap. */
  readonly wallClockMs: FrameSpread;
  /** GPU time of each stage; null without timestamps. */
  readonly stageMs: Readonly<Record<'preprocess' | 'sort' | 'rasterize', FrameSpread>> | null;
  /**
   * Each stage by itself, in the order of the frame, from as many further frames of the same
   * cameras; null without timestamps. The GPU pauses between passes: their sum exceeds the time of
   * the undivided frame. Browsers round timestamps to about a tenth of a millisecond by default.
   */
  readonly passes: readonly PassCost[] | null;
  /** Bytes per second, read plus written, that the device moves when it copies large buffers. */
  readonly copyBytesPerSecond: number;
  /** Memory of the engine while it held the whole frames. */
  readonly memory: GpuMemoryReport;
  /** Cautions, in sentences. */
  readonly notes: readonly string[];
}

/** Frames before the first measured one: they make shaders and buffers. */
const WARM_UP_FRAMES = 3;
/** As many if a rasteriser is to be chosen: enough to compare both. */
const CHOICE_FRAMES = 30;

/**
 * Measures the time of frames on this device: of whole frames, and of each pass with the bytes that
 * it must move. Draws in a view of its own. Each frame is complete before the next begins, and other
 * tasks of the thread run in between. Every frame is culled, sorted and drawn anew.
 *
 * If the settings leave the rasteriser open, the faster one is found first, and draws all measured
 * frames. All cameras are drawn once before any is measured.
 *
 * @throws InvalidArgumentError, GpuLimitError, DestroyedError; the reason of `signal`.
 * @example
 * const cameras = orbitCameras(camera, cloud.robustBounds, { count: 60, sweepDegrees: 30 });
 * const options = { clouds: [{ cloud }], cameras, widthPx, heightPx };
 * const { adapter, gpuMs, wallClockMs } = await measureFrames(engine, options);
 * console.log(`${(gpuMs ?? wallClockMs).median} ms on ${adapter}`);
 */
export async function measureFrames(
  engine: MeasuredEngine,
  options: MeasureFramesOptions,
): Promise<FrameMeasurement> {
  checkMeasured(engine, options);
  return withView(engine, async (view) => {
    const runs = await drawFrames(engine, view, options);
    const { drawn, profiled } = runs;
    const timings = drawn.map(({ timing }) => timing);
    const hasTimestamps = profiled !== null;
    const stageMs = (stage: 'preprocessMs' | 'sortMs' | 'rasterizeMs') =>
      frameSpread(timings.map((timing) => timing[stage]));
    const pairs = drawn.flatMap(({ tilePairs }) => tilePairs ?? []);
    return {
      adapter: engine.adapterLabel,
      settings: runs.settings,
      rasterizer: { rasterizer: drawn.at(-1)!.rasterizer, reason: runs.reason },
      widthPx: options.widthPx,
      heightPx: options.heightPx,
      frames: drawn.length,
      loadedSplats: drawn[0].loadedSplats,
      candidateSplats: countSpread(drawn.map(({ candidateSplats }) => candidateSplats)),
      visibleSplats: countSpread(drawn.map(({ visibleSplats }) => visibleSplats)),
      tilePairs: pairs.length === drawn.length ? countSpread(pairs) : null,
      timing: timings[0].source,
      gpuMs: hasTimestamps ? frameSpread(timings.map(({ totalMs }) => totalMs)) : null,
      wallClockMs: frameSpread(timings.map(({ wallClockMs }) => wallClockMs)),
      stageMs: hasTimestamps
        ? { preprocess: stageMs('preprocessMs'), sort: stageMs('sortMs'), rasterize: stageMs('rasterizeMs') }
        : null,
      passes: profiled && passCosts(profiled, bytesOfFrames(view, drawn, options)),
      copyBytesPerSecond: await measureCopyBandwidth(engine.device, { bytes: options.copyBytes }),
      memory: runs.memory,
      notes: [...runs.notices, ...clockNotes(timings)],
    };
  });
}

interface Runs {
  /** The requested settings with the chosen rasteriser. */
  readonly settings: AccuracySettings;
  readonly reason: string;
  readonly notices: readonly string[];
  /** The whole frames, one per camera. */
  readonly drawn: readonly FrameStatistics[];
  readonly memory: GpuMemoryReport;
  /** Passes of a further frame per camera; null without timestamps. */
  readonly profiled: readonly PassTime[][] | null;
}

async function drawFrames(
  engine: MeasuredEngine,
  view: MeasuredView,
  {
    cameras,
    clouds,
    widthPx,
    heightPx,
    sortBy,
    detail,
    accuracy = engine.accuracy,
    signal,
    onProgress,
  }: MeasureFramesOptions,
): Promise<Runs> {
  const asked = engine.resolveAccuracy(isAccuracyTarget(accuracy) ? engine.accuracy : accuracy);
  const hasTimestamps = engine.device.features.has('timestamp-query');
  const warmUpFrames = asked.settings.rasterizer === 'auto' ? CHOICE_FRAMES : WARM_UP_FRAMES;
  const total = warmUpFrames + cameras.length * (hasTimestamps ? 3 : 2);
  let done = 0;
  const step = (label: string) => {
    signal?.throwIfAborted();
    callListener(onProgress, { done: done++, total, label });
  };
  let { settings } = asked;
  const frame = (camera: Camera): FrameRequest => ({
    ...{ camera, clouds, widthPx, heightPx, sortBy, detail },
    accuracy: settings,
    force: true,
  });
  for (let i = 0; i < warmUpFrames; i++) {
    step('Warming up');
    await drawMeasured(engine, view, frame(cameras[i % cameras.length]));
  }
  const { rasterizer, reason } = view.rasterizer;
  settings = engine.resolveAccuracy({ ...settings, rasterizer }).settings;
  // Once around with the settled choice, so that all buffers have grown.
  for (const camera of cameras) {
    step('Going around');
    await drawMeasured(engine, view, frame(camera));
  }
  const drawn: FrameStatistics[] = [];
  for (const camera of cameras) {
    step('Timing frames');
    drawn.push(await drawMeasured(engine, view, frame(camera)));
  }
  const memory = engine.memory();
  const runs = { settings, reason, notices: asked.notices, drawn, memory };
  if (!hasTimestamps) return { ...runs, profiled: null };
  const profiled: PassTime[][] = [];
  await withProfile(view, async (profile) => {
    for (const camera of cameras) {
      step('Timing passes');
      view.render(frame(camera));
      await view.whenDrawn();
      profiled.push(await profile.read());
    }
  });
  return { ...runs, profiled };
}

async function withProfile(view: MeasuredView, use: (profile: FrameProfile) => Promise<void>): Promise<void> {
  const profile = new FrameProfile(view.blended().context.memory);
  view.profile = profile;
  try {
    await use(profile);
  } finally {
    view.profile = null;
    profile.destroy();
  }
}

type BytesOfFrame = ReturnType<typeof leastBytes>;

/** Profiled frames have no statistics of their own: the camera's whole frame has them. */
function bytesOfFrames(
  view: MeasuredView,
  drawn: readonly FrameStatistics[],
  size: Pick<FrameRequest, 'widthPx' | 'heightPx'>,
): BytesOfFrame[] {
  const { context, color } = view.blended();
  const pixelBytes = context.memory.bytesOf(color) / (size.widthPx * size.heightPx);
  return drawn.map((statistics) => leastBytes({ shape: view.shape!, statistics, size, pixelBytes }));
}

/** @param profiled per frame; passes that a frame did not run took no time in it. */
function passCosts(profiled: readonly PassTime[][], bytesOf: readonly BytesOfFrame[]): PassCost[] {
  const found = new Map(profiled.flat().map(({ part, stage }) => [`${part}/${stage}`, { part, stage }]));
  return [...found.values()].map(({ part, stage }) => {
    const runs = profiled.map((passes) => passes.find((pass) => pass.part === part && pass.stage === stage));
    const timeMs = timeSpread(runs.map((run) => run?.elapsedMs ?? 0));
    const bytes = bytesOf.flatMap((bytesOfFrame) => bytesOfFrame(part, stage) ?? []);
    const medianOf = (kind: keyof PassBytes) => timeSpread(bytes.map((each) => each[kind])).median;
    const median = bytes.length > 0 ? { read: medianOf('read'), written: medianOf('written') } : null;
    const moved = median ? median.read + median.written : 0;
    return {
      part,
      stage,
      dispatches: runs.reduce((most, run) => Math.max(most, run?.dispatches ?? 0), 0),
      timeMs,
      bytes: median,
      bytesPerSecond: moved > 0 && timeMs.median > 0 ? moved / (timeMs.median / 1000) : null,
    };
  });
}

function frameSpread(values: readonly number[]): FrameSpread {
  return { ...timeSpread(values), standardDeviation: standardDeviation(values) };
}

function countSpread(values: readonly number[]): CountSpread {
  const least = values.reduce((a, b) => Math.min(a, b), Number.POSITIVE_INFINITY);
  const most = values.reduce((a, b) => Math.max(a, b), Number.NEGATIVE_INFINITY);
  return { least, median: timeSpread(values).median, most };
}
