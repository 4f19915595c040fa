import type { FixedDetail } from '../frame/detail.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import { compareViews } from './compare-views.ts';
import { type CutPoint, MOST_SHARE, predictPsnrDb, predictShare } from './cut-curve.ts';
import type { MeasuredEngine } from './measured-engine.ts';
import { withView } from './measured-frames.ts';

/** A cut that was predicted, then measured. */
export interface MeasuredCut extends CutPoint {
  readonly predictedPsnrDb: number;
}

/** Detail chosen by measuring pictures. */
export interface DetailChoice {
  /** The fewest splats measured that reach the PSNR; `full` where no cut does that saves time. */
  readonly detail: FixedDetail;
  /** Of the picture with this detail, against the full one by `reference`. */
  readonly psnrDb: number;
  /** The cuts that were drawn, in order. */
  readonly measured: readonly MeasuredCut[];
}

const LEAST_SHARE = 1 / 512;
const CUTS = 2;
/** Cuts aim at this much more than is asked for; a first one that exceeds it by no more than … stays. */
const AIM_DB = 1;
const CLOSE_DB = 2;

/**
 * Chooses the fewest splats whose picture is within `minPsnrDb` of the full one by the settings
 * `reference`, as far as the clouds hold their planes: predicts a cut, measures it, and another by
 * what it has shown. The promise holds for this very frame, since only cuts are chosen that were
 * measured.
 *
 * @param frame with the settings to draw with; their error counts too.
 * @param before cuts of these clouds that were measured before, from any camera.
 * @throws GpuLimitError, DestroyedError; the reason of `signal`.
 */
export async function chooseDetail(
  engine: MeasuredEngine,
  minPsnrDb: number,
  frame: FrameRequest,
  { before = [], signal }: { readonly before?: readonly CutPoint[]; readonly signal?: AbortSignal } = {},
): Promise<DetailChoice> {
  const full: FrameRequest = { ...frame, detail: 'full', force: true };
  return withView(engine, async (reference) => {
    reference.render({ ...full, accuracy: engine.resolveAccuracy('reference').settings });
    const compared = (detail: FixedDetail) =>
      withView(engine, async (view) => {
        signal?.throwIfAborted();
        view.render({ ...full, detail });
        return (await compareViews(view, reference)).psnrDb;
      });
    const measured: MeasuredCut[] = [];
    let share = predictShare(before, minPsnrDb + AIM_DB);
    for (let cut = 0; cut < CUTS; cut++) {
      share = Math.min(Math.max(share, LEAST_SHARE), MOST_SHARE);
      if (measured.some((one) => one.share === share)) break;
      const predictedPsnrDb = predictPsnrDb(measured.length > 0 ? measured : before, share);
      const psnrDb = await compared({ maxShare: share });
      measured.push({ share, psnrDb, predictedPsnrDb });
      if (psnrDb >= minPsnrDb && psnrDb <= minPsnrDb + CLOSE_DB) break;
      share = predictShare(measured, minPsnrDb + AIM_DB);
    }
    const enough = measured.filter(({ psnrDb }) => psnrDb >= minPsnrDb).sort((a, b) => a.share - b.share);
    if (enough.length > 0)
      return { detail: { maxShare: enough[0].share }, psnrDb: enough[0].psnrDb, measured };
    return { detail: 'full', psnrDb: await compared('full'), measured };
  });
}
