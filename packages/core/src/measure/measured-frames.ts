import { WebSplatterError } from '../errors.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { FrameStatistics } from '../timing/frame-statistics.ts';
import type { MeasuredEngine, MeasuredView } from './measured-engine.ts';

/** Statistics that have not arrived this long after the GPU was done never will. */
const STATISTICS_TIMEOUT_MS = 5000;

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
 * Draws `frame`, which must differ from the last one or be forced, and waits until it has been drawn and measured. Other
 * tasks of the thread run in the meantime. A frame that also drew a sample of the quads, which is no part of its image, is
 * drawn again.
 *
 * @throws DestroyedError if the engine or the device ends first.
 */
export async function drawMeasured(
  engine: MeasuredEngine,
  view: MeasuredView,
  frame: FrameRequest,
): Promise<FrameStatistics> {
  for (let next = frame; ; next = { ...frame, force: true }) {
    const statistics = await drawOnce(engine, view, next);
    if (statistics.quadsSampleMs === null) return statistics;
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
