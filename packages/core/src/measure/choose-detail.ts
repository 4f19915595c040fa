import { type CutPoint, MOST_SHARE, predictShare } from '../data/accuracy/cut-curve.ts';
import type { FixedDetail } from '../frame/plan/detail.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { compareViews } from './compare-views.ts';
import type { MeasuredEngine } from './measured-engine.ts';
import { drawMeasured, withView } from './measured-frames.ts';
import { predictCuts } from './predict-cuts.ts';

// Exported from here, so that bundlers put both functions into one chunk. With two, the code that
// both import would become part of the engine's chunk.
export { predictCuts };

/** Detail chosen by measuring pictures. */
export interface DetailChoice {
  /** The fewest measured splats that reach the PSNR; `full` if no cut does, or if it saves no time. */
  readonly detail: FixedDetail;
  /** PSNR of the picture with this detail, against the full picture by `reference`. */
  readonly psnrDb: number;
  /** The cuts that were drawn, in order; empty if no cloud has levels. */
  readonly measured: readonly CutPoint[];
}

const LEAST_SHARE = 1 / 512;
/** Most cuts that are drawn; two are enough if the first is close. */
const MOST_CUTS = 4;
/** Cuts aim at `minPsnrDb` and this much more. */
const AIM_DB = 0.5;
/** The search ends with a cut that exceeds `minPsnrDb` by no more than this. */
const CLOSE_DB = 1;
/** Frames that are timed with the cut, and with full detail; the quickest of each counts. */
const TIMED_FRAMES = 3;

/**
 * Chooses the fewest splats whose picture has a PSNR of `minPsnrDb` or more against the full
 * picture by the settings `reference`, as far as the clouds hold planes for them. Predicts a cut
 * (`predictCuts`), measures it, and predicts the next from the result. Only measured cuts are
 * chosen, so the PSNR holds for this frame.
 *
 * @param frame frame to draw, with its settings; their error counts too.
 * @param before cuts of these clouds from other cameras: where to begin.
 * @throws GpuLimitError, DestroyedError; the reason of `signal`.
 */
export async function chooseDetail(
  engine: MeasuredEngine,
  minPsnrDb: number,
  frame: FrameRequest,
  { before = [], signal }: { readonly before?: readonly CutPoint[]; readonly signal?: AbortSignal } = {},
): Promise<DetailChoice> {
  const full: FrameRequest = { ...frame, detail: 'full', force: true };
  const predicted = await predictCuts(engine, minPsnrDb + AIM_DB, frame, { before, signal });
  return withView(engine, (reference) =>
    withView(engine, async (view) => {
      reference.render({ ...full, accuracy: engine.resolveAccuracy('reference').settings });
      const psnrOf = async (detail: FixedDetail) => {
        signal?.throwIfAborted();
        view.render({ ...full, detail });
        return (await compareViews(view, reference)).psnrDb;
      };
      const msOf = async (detail: FixedDetail) => {
        let leastMs = Number.POSITIVE_INFINITY;
        for (let frame = 0; frame < TIMED_FRAMES; frame++) {
          signal?.throwIfAborted();
          const { timing } = await drawMeasured(engine, view, { ...full, detail });
          leastMs = Math.min(leastMs, timing.totalMs);
        }
        return leastMs;
      };
      const measured: CutPoint[] = [];
      let best: CutPoint | null = null;
      while (measured.length < MOST_CUTS) {
        const wanted = predictShare(measured.length > 0 ? measured : predicted, minPsnrDb + AIM_DB);
        const share = Math.min(Math.max(wanted, LEAST_SHARE), MOST_SHARE);
        if (measured.some((cut) => cut.share === share)) break;
        const cut = { share, psnrDb: await psnrOf({ maxShare: share }) };
        // No cloud has levels to cut: clouds may be loading, or lack memory for levels.
        if (!view.shape?.clouds.some(({ levels }) => levels))
          return { detail: 'full', psnrDb: cut.psnrDb, measured: [] };
        measured.push(cut);
        const reaches = cut.psnrDb >= minPsnrDb;
        if (reaches && share < (best?.share ?? Number.POSITIVE_INFINITY)) best = cut;
        if (reaches && cut.psnrDb <= minPsnrDb + CLOSE_DB) break;
      }
      const cut = best && { maxShare: best.share };
      if (cut && (await msOf(cut)) < (await msOf('full')))
        return { detail: cut, psnrDb: best!.psnrDb, measured };
      return { detail: 'full', psnrDb: await psnrOf('full'), measured };
    }),
  );
}
