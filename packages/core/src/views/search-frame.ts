import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';
import type { ViewFrames } from './view-frames.ts';

/**
 * Runs `find` over a view's last frame, once its stage is compiled. Null without a frame.
 *
 * @throws DestroyedError
 */
export async function searchFrame<Found>(
  frames: ViewFrames,
  stageOf: (plan: FramePlan) => StageDefinition,
  find: (plan: FramePlan, stage: StageDefinition) => Promise<Found>,
): Promise<Found | null> {
  const { pipelines } = frames.context;
  for (;;) {
    // While the stage compiles, a frame with other record formats may be drawn, or the view
    // destroyed.
    frames.checkUsable();
    if (!frames.last) return null;
    const stage = stageOf(frames.last);
    if (pipelines.areReady([stage])) return find(frames.last, stage);
    await pipelines.prepare([stage]);
  }
}
