import { WebSplatterError } from '../errors.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { StageTimings } from '../timing/frame-statistics.ts';
import type { MeasuredEngine, MeasuredView } from './measured-engine.ts';

/** A measurement that has not come this long after the GPU was done is not coming. */
const STATISTICS_TIMEOUT_MS = 5000;

/** Runs `use` with a view that lasts as long: what it holds on the GPU is gone afterwards. */
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
 * Draws `frame`, which has to be another one than the last or to be forced, and waits until it is drawn and measured: other tasks of the thread
 * run meanwhile.
 *
 * @throws DestroyedError where the engine or the device ends meanwhile.
 */
export async function drawMeasured(
  engine: MeasuredEngine,
  view: MeasuredView,
  frame: FrameRequest,
): Promise<StageTimings> {
  const measured = new Promise<StageTimings>((resolve) => {
    view.onStatistics = ({ timing }) => resolve(timing);
  });
  view.render(frame);
  await view.whenDrawn();
  await Promise.race([engine.device.queue.onSubmittedWorkDone().catch(() => {}), engine.lost]);
  // Throws where nothing can come any more.
  view.blended();
  let timer: ReturnType<typeof setTimeout> | undefined;
  const givenUp = new Promise<never>((_, reject) => {
    timer = setTimeout(() => {
      reject(new WebSplatterError('gpu-error', 'The GPU drew a picture and never said how long it took.'));
    }, STATISTICS_TIMEOUT_MS);
  });
  try {
    return await Promise.race([measured, givenUp]);
  } finally {
    clearTimeout(timer);
    view.onStatistics = null;
  }
}
