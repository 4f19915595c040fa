import type { Vec3 } from '../camera/vec3.ts';
import type { SavedView } from '../state/saved-view.ts';

/** More of one scene are not kept: browsers give a site a few megabytes. */
export const MAX_SAVED_VIEWS = 50;

/** Under which key the views of a scene are kept in the browser. */
export function viewListKey(sceneTitle: string): string {
  return `websplatter:views:${sceneTitle}`;
}

/** Reads the stored views, without invalid ones, which must not keep the viewer from starting. */
export function readViewList(text: string | null): readonly SavedView[] {
  if (text === null) return [];
  try {
    const list: unknown = JSON.parse(text);
    return Array.isArray(list) ? list.filter(isSavedView).slice(0, MAX_SAVED_VIEWS) : [];
  } catch {
    return [];
  }
}

function isSavedView(value: unknown): value is SavedView {
  if (typeof value !== 'object' || value === null) return false;
  const { pose, fovDegrees, isOrthographic, isFlipped, isZUp, thumbnail } = value as Partial<SavedView>;
  return (
    typeof pose === 'object' &&
    pose !== null &&
    isPoint(pose.target) &&
    isPoint(pose.up) &&
    Math.abs(Math.hypot(...pose.up) - 1) < 1e-6 &&
    [pose.azimuth, pose.polar].every(Number.isFinite) &&
    Number.isFinite(pose.distance) &&
    pose.distance > 0 &&
    typeof fovDegrees === 'number' &&
    fovDegrees > 0 &&
    fovDegrees < 180 &&
    [isOrthographic, isFlipped, isZUp].every((each) => typeof each === 'boolean') &&
    typeof thumbnail === 'string'
  );
}

function isPoint(value: unknown): value is Vec3 {
  return Array.isArray(value) && value.length === 3 && value.every(Number.isFinite);
}
