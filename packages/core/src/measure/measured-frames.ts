import { WebSplatterError } from '../data/errors.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { type FrameStatistics, isPlausible, type StageTimings } from '../gpu/timing/frame-statistics.ts';
import type { MeasuredEngine, MeasuredView } from './measured-engine.ts';

/** Longest wait for statistics after the GPU was done: later ones are assumed lost. */
const STATISTICS_TIMEOUT_MS = 5000;
/** Most frames that are drawn for tile lists: the frame after one with known pairs has room for them. */
const ATTEMPTS_AT_ROOM = 3;

/** Runs `use` with a view that is destroyed afterwards. */
export async function withView<Result>(
  engine: MeasuredEngine,
  use: (view: MeasuredView) => Promise<Result>,
): Promise<Result> {
  const view = engine.createView();
  try {
    return await use(view);
  } finally {
    view.destroy();
  }
}

/**
 * Draws `frame`, which must differ from the last one or be forced, and waits until it has been
 * drawn and measured. Other tasks of the thread run in the meantime. Draws the frame again if it
 * also drew a sample of quads, or if quads drew it because the tile lists were too short yet.
 *
 * @throws DestroyedError if the engine or the device ends first.
 */
export async function drawMeasured(
  engine: MeasuredEngine,
  view: MeasuredView,
  frame: FrameRequest,
): Promise<FrameStatistics> {
  for (let attempt = 1; ; attempt++) {
    const statistics = await drawOnce(engine, view, attempt === 1 ? frame : { ...frame, force: true });
    const { tilePairs, rasterizer, quadsSampleMs } = statistics;
    // Pairs beyond the budget never find room.
    const lacksRoom = tilePairs !== null && rasterizer === 'quads' && attempt < ATTEMPTS_AT_ROOM;
    if (quadsSampleMs === null && !lacksRoom) return statistics;
  }
}

async function drawOnce(
  engine: MeasuredEngine,
  view: MeasuredView,
  frame: FrameRequest,
): Promise<FrameStatistics> {
  const measured = new Promise<FrameStatistics>((resolve) => {
    view.onStatistics = resolve;
  });
  view.render(frame);
  await view.whenDrawn();
  // A lost device may reject; the next line throws for it.
  await Promise.race([engine.device.queue.onSubmittedWorkDone().catch(() => {}), engine.lost]);
  // Throws if the view can no longer draw, and so nothing will arrive.
  view.blended();
  let timer: ReturnType<typeof setTimeout> | undefined;
  const givenUp = new Promise<never>((_, reject) => {
    timer = setTimeout(() => {
      reject(new WebSplatterError('gpu-error', 'The GPU drew a frame but never reported its time.'));
    }, STATISTICS_TIMEOUT_MS);
  });
  try {
    return await Promise.race([measured, givenUp]);
  } finally {
    clearTimeout(timer);
    view.onStatistics = null;
  }
}

/** A note if the GPU's and the CPU's clock contradict each other in most of the frames. */
export function clockNotes(timings: readonly StageTimings[]): string[] {
  const implausible = timings.filter((timing) => !isPlausible(timing)).length;
  return implausible > timings.length / 2
    ? ['GPU timestamps and wall clock disagree by more than a factor of three here.']
    : [];
}
