import { ACCURACY_SETTINGS, DEFAULT_ACCURACY } from '../data/accuracy/accuracy.ts';
import type { AccuracyTarget } from '../data/accuracy/accuracy-target.ts';
import { isFixedDetail } from '../frame/plan/detail.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { isSoftwareAdapter } from '../gpu/device.ts';
import { type AccuracyChoice, chooseFrom } from './choose-accuracy.ts';
import { type MeasureProgress, measureThen } from './measure-accuracy.ts';
import type { MeasuredEngine } from './measured-engine.ts';
import { sampleCameras } from './sample-cameras.ts';
import { worldBounds } from './world-bounds.ts';

/** The fewest frames with a 95 % interval: an application waits, and draws in between. */
const FRAMES = 6;
/** The paper's ablations draw the same image more slowly: no target needs them. */
const ABLATED: readonly string[] = ['extent', 'culling'];
const SETTINGS = Object.keys(ACCURACY_SETTINGS).filter((name) => !ABLATED.includes(name));

/** A software rasteriser takes as long for a frame as a GPU for a hundred, and varies less. */
const SOFTWARE_FRAMES = 3;
/** A software rasteriser's time depends on the number of pixels. */
const SOFTWARE_SETTINGS = ['resolutionScale'];

export interface TargetOptions {
  readonly signal: AbortSignal;
  readonly onProgress?: (progress: MeasureProgress) => void;
  /** The current choice, which stays unless the measurement shows that another is better. */
  readonly previous: AccuracyChoice | null;
}

/**
 * Measures the frame of a request, from its camera and from around it, and chooses the settings
 * that meet the target or come closest. Afterwards the clouds hold the planes of the choice and all
 * planes that they held before.
 *
 * @throws errors of `measureAccuracy`.
 */
export async function measureTarget(
  engine: MeasuredEngine,
  target: AccuracyTarget,
  { camera, clouds, widthPx, heightPx, sortBy, detail = 'full' }: FrameRequest,
  { previous, signal, onProgress }: TargetOptions,
): Promise<AccuracyChoice> {
  const isSoftware = isSoftwareAdapter(engine.device.adapterInfo);
  const options = {
    clouds,
    cameras: isSoftware ? [camera] : sampleCameras(camera, worldBounds(clouds)),
    widthPx,
    heightPx,
    sortBy,
    detail: isFixedDetail(detail) ? detail : 'full',
    base: DEFAULT_ACCURACY,
    settings: isSoftware ? SOFTWARE_SETTINGS : SETTINGS,
    ablations: false,
    frames: isSoftware ? SOFTWARE_FRAMES : FRAMES,
    combinations: !isSoftware,
    signal,
    onProgress,
  };
  const choose = (table: AccuracyChoice['table']) => chooseFrom(table, target, previous ?? undefined);
  const choice = await measureThen(engine, options, choose, ({ settings }) => settings);
  if (!isSoftware) return choice;
  return { ...choice, why: `${choice.why} Without a GPU, only a few settings were measured, in this view.` };
}
