import type { Look } from '../scene/inspect-messages.ts';
import type { InspectTools } from './inspect-tools.ts';

/** How the image on the screen looks at the scene; null where there is none. */
export function shownLook({ store, viewer }: Pick<InspectTools, 'store' | 'viewer'>): Look | null {
  const camera = viewer.shownFrame?.frame.camera;
  if (!camera) return null;
  const { isFlipped } = store.getState();
  const viewMatrix = Array.from(camera.viewMatrix);
  const projectionMatrix = Array.from(camera.projectionMatrix);
  return { viewMatrix, projectionMatrix, isFlipped };
}
