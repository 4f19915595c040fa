import { DestroyedError, type SplatPick } from '@websplatter/core';
import { detailOfFrames } from '../state/accuracy.ts';
import type { InspectTools } from './inspect-tools.ts';

/**
 * Finds the splat that contributes most at `xPart`, `yPart` from the image's top left; null if
 * there is none; also if it cannot be found, which a notice says. Always picks at full detail: merged splats are not in the file and lie between
 * several splats.
 */
export async function pickSplat(
  { viewer, store }: Pick<InspectTools, 'viewer' | 'store'>,
  xPart: number,
  yPart: number,
): Promise<SplatPick | null> {
  const { shownFrame, scenes } = viewer;
  const state = store.getState();
  const { accuracy } = state;
  if (!shownFrame || detailOfFrames(state) === 'full') return viewer.pickAt(xPart, yPart);
  const { engine, frame } = shownFrame;
  const { newest } = scenes;
  const view = engine.createView();
  try {
    view.render({ ...frame, accuracy, detail: 'full' });
    const pick = await view.pick(xPart * frame.widthPx, yPart * frame.heightPx);
    return scenes.newest === newest ? pick : null;
  } catch (error) {
    // The session may have ended, or another scene been opened.
    if (scenes.newest === newest && !(error instanceof DestroyedError))
      store.setState({ notice: (error as Error).message });
    return null;
  } finally {
    view.destroy();
  }
}
