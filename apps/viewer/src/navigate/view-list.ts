import { isFiniteF32 } from '../state/float32.ts';
import {
  type KeptView,
  LEAST_STEP_MS,
  PASSINGS,
  type PathSettings,
  type SavedView,
} from '../state/saved-view.ts';
import { encodeKeptView } from '../state/scene-link-fields.ts';
import type { Vec3 } from '../state/vec3.ts';

/** Most views stored for a scene: browsers give a site a few megabytes. */
export const MAX_SAVED_VIEWS = 50;

/** Storage key of a scene's views. */
export function viewListKey(contentKey: string): string {
  return `websplatter:views:${contentKey}`;
}

/** Reads stored views; skips invalid ones, which must not prevent the viewer from starting. */
export function readViewList(text: string | null): readonly SavedView[] {
  if (text === null) return [];
  try {
    const list: unknown = JSON.parse(text);
    if (!Array.isArray(list)) return [];
    // Views stored by old versions have no names.
    const named = list.map((each) => (isObject(each) ? { name: '', ...each } : each));
    return named.filter(isSavedView).slice(0, MAX_SAVED_VIEWS);
  } catch {
    // What is stored is no JSON: there are no views, as on a first visit.
    return [];
  }
}

/**
 * Views of a link, with the stored thumbnail of the same view. Then the other stored views.
 */
export function joinedViews(linked: readonly SavedView[], kept: readonly SavedView[]): readonly SavedView[] {
  const left = new Map(kept.map((view) => [encodeKeptView(view), view]));
  const first = linked.map((view) => {
    const text = encodeKeptView(view);
    const same = left.get(text);
    left.delete(text);
    return same ? { ...view, thumbnail: same.thumbnail } : view;
  });
  return [...first, ...left.values()].slice(0, MAX_SAVED_VIEWS);
}

/** Storage key of a scene's path. */
export function pathKey(contentKey: string): string {
  return `websplatter:path:${contentKey}`;
}

/** Reads the stored path: a list of one, or of none if it is invalid. */
export function readPath(text: string | null): readonly PathSettings[] {
  if (text === null) return [];
  try {
    const path: unknown = JSON.parse(text);
    return isPath(path) ? [path] : [];
  } catch {
    // What is stored is no JSON: there is no path, as on a first visit.
    return [];
  }
}

function isPath(value: unknown): value is PathSettings {
  if (!isObject(value)) return false;
  const { isLooped, turntable } = value as Partial<PathSettings>;
  if (typeof isLooped !== 'boolean') return false;
  return (
    turntable === null ||
    (isObject(turntable) && isKeptView(turntable.view) && isTime(turntable.durationMs, 4 * LEAST_STEP_MS))
  );
}

function isObject(value: unknown): value is object {
  return typeof value === 'object' && value !== null;
}

function isSavedView(value: unknown): value is SavedView {
  if (!isKeptView(value)) return false;
  const { name, thumbnail, toNextMs, passing } = value as Partial<SavedView>;
  return (
    typeof name === 'string' &&
    (thumbnail === null || typeof thumbnail === 'string') &&
    (toNextMs === undefined || isTime(toNextMs, LEAST_STEP_MS)) &&
    (passing === undefined || PASSINGS.includes(passing))
  );
}

function isTime(value: unknown, leastMs: number): boolean {
  return typeof value === 'number' && Number.isFinite(value) && value >= leastMs;
}

function isKeptView(value: unknown): value is KeptView {
  if (!isObject(value)) return false;
  const { pose, fovDegrees, isOrthographic, isFlipped, isZUp } = value as Partial<KeptView>;
  return (
    isObject(pose) &&
    isPoint(pose.target) &&
    isPoint(pose.up) &&
    Math.abs(Math.hypot(...pose.up) - 1) < 1e-6 &&
    [pose.azimuth, pose.polar].every(Number.isFinite) &&
    isFiniteF32(pose.distance) &&
    pose.distance > 0 &&
    typeof fovDegrees === 'number' &&
    fovDegrees > 0 &&
    fovDegrees < 180 &&
    [isOrthographic, isFlipped, isZUp].every((each) => typeof each === 'boolean')
  );
}

function isPoint(value: unknown): value is Vec3 {
  return Array.isArray(value) && value.length === 3 && value.every(isFiniteF32);
}
