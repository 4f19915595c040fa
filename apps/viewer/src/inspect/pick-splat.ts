import type { SplatPick } from '@websplatter/core';
import { detailOfFrames } from '../state/accuracy.ts';
import type { InspectTools } from './inspect-tools.ts';

/**
 * The splat that contributes most at `xPart`, `yPart` from the image's top left, or null: of all
 * splats, whatever the detail, since a merged splat is not in the file and lies between several.
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
  } catch {
    // The session has ended, or another scene is shown.
    return null;
  } finally {
    view.destroy();
  }
}
