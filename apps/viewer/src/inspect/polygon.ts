import type { PicturePoint } from '../camera/picture-space.ts';
import type { DragRegion } from '../state/selecting.ts';

/** A polygon being drawn: its corners, followed by the pointer's position. */
type Polygon = Extract<DragRegion, { kind: 'polygon' }>;

const FEWEST_CORNERS = 3;

/** Moves the polygon's last point to the pointer; null starts a new polygon without corners. */
export function withPointerAt(polygon: Polygon | null, at: PicturePoint): Polygon {
  return { kind: 'polygon', points: [...cornersOf(polygon), ...at] };
}

/** Sets a corner at the pointer. */
export function withCorner(polygon: Polygon): Polygon {
  return { ...polygon, points: [...polygon.points, ...polygon.points.slice(-2)] };
}

/** Removes the last corner; null if it was the only one. */
export function withoutCorner({ points }: Polygon): Polygon | null {
  return points.length > 4
    ? { kind: 'polygon', points: [...points.slice(0, -4), ...points.slice(-2)] }
    : null;
}

/** The polygon of the set corners, without the pointer; null if there are too few. */
export function closed(polygon: Polygon): Polygon | null {
  const points = cornersOf(polygon);
  return points.length < 2 * FEWEST_CORNERS ? null : { kind: 'polygon', points };
}

/** Whether the pointer is within `reachPx` of the first corner and there are enough corners. */
export function isAtStart(polygon: Polygon, reachPx: number): boolean {
  const [x, y] = polygon.points;
  const [pointerX, pointerY] = polygon.points.slice(-2);
  return closed(polygon) !== null && Math.hypot(pointerX - x, pointerY - y) <= reachPx;
}

export function cornersOf(polygon: Polygon | null): readonly number[] {
  return polygon?.points.slice(0, -2) ?? [];
}
