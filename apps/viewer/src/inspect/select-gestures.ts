import type { PicturePoint, PictureSpace } from '../camera/picture-space.ts';
import { MAX_WAY_PX } from '../camera/tap.ts';
import type { DragRegion, SelectMode, SelectTool } from '../state/selecting.ts';
import type { Vec3 } from '../state/vec3.ts';
import { closed, isAtStart, withCorner, withPointerAt } from './polygon.ts';
import type { SplatSelecting } from './splat-selecting.ts';

/** A shorter drag counts as a click, without a rectangle. */
const LEAST_SIDE_PX = 3;

type Polygon = Extract<DragRegion, { kind: 'polygon' }>;

/** How a pressed pointer changes the selection. */
export interface SelectGesture {
  readonly move: (to: PicturePoint) => void;
  readonly end: (mode: SelectMode) => void;
  readonly cancel: () => void;
}

/** State in which a gesture begins. */
export interface GestureStart {
  readonly space: PictureSpace;
  /** Distance from the first corner at which a click closes a polygon, CSS px. */
  readonly reachPx: number;
}

/** The gesture of a pointer pressed at `from`; null if drags of the tool move the camera. */
export function beginGesture(
  tool: SelectTool,
  selecting: SplatSelecting,
  from: PicturePoint,
  { space, reachPx }: GestureStart,
): SelectGesture | null {
  switch (tool) {
    case 'rectangle':
      return shapeGesture(selecting, { kind: 'rectangle', from, to: from }, space);
    case 'brush':
      return shapeGesture(
        selecting,
        { kind: 'brush', points: from, radius: selecting.now.brushRadius },
        space,
      );
    case 'polygon':
      return cornerGesture(selecting, from, space, reachPx);
    case 'sphere':
      return sphereGesture(selecting, from, space);
    case 'color':
      return null;
  }
}

function shapeGesture(
  selecting: SplatSelecting,
  begun: Exclude<DragRegion, { kind: 'polygon' }>,
  { width, height }: PictureSpace,
): SelectGesture {
  let dragged = begun;
  const show = () => selecting.choose({ dragged });
  const cancel = () => selecting.choose({ dragged: null });
  show();
  return {
    move: (to) => {
      dragged =
        dragged.kind === 'brush' ? { ...dragged, points: [...dragged.points, ...to] } : { ...dragged, to };
      show();
    },
    end: (mode) => {
      cancel();
      if (!isEmpty(dragged)) void selecting.selectDragged(dragged, width, height, mode);
    },
    cancel,
  };
}

function isEmpty(dragged: DragRegion): boolean {
  if (dragged.kind !== 'rectangle') return false;
  const { from, to } = dragged;
  return Math.min(Math.abs(from[0] - to[0]), Math.abs(from[1] - to[1])) < LEAST_SIDE_PX;
}

/** The polygon being drawn; null if there is none. */
export function drawnPolygon({ now }: SplatSelecting): Polygon | null {
  return now.dragged?.kind === 'polygon' ? now.dragged : null;
}

/** Selects the splats in the polygon being drawn, unless it has too few corners. */
export function closePolygon(
  selecting: SplatSelecting,
  { width, height }: PictureSpace,
  mode: SelectMode,
): void {
  const polygon = drawnPolygon(selecting);
  const dragged = polygon && closed(polygon);
  if (!dragged) return;
  selecting.choose({ dragged: null });
  void selecting.selectDragged(dragged, width, height, mode);
}

/** Sets a corner where the pointer is released, or closes the polygon there. */
export function cornerGesture(
  selecting: SplatSelecting,
  from: PicturePoint,
  space: PictureSpace,
  reachPx: number,
): SelectGesture {
  const before = drawnPolygon(selecting);
  const move = (to: PicturePoint) =>
    selecting.choose({ dragged: withPointerAt(drawnPolygon(selecting), to) });
  move(from);
  return {
    move,
    end: (mode) => {
      const polygon = drawnPolygon(selecting);
      if (polygon && isAtStart(polygon, reachPx)) closePolygon(selecting, space, mode);
      else if (polygon) selecting.choose({ dragged: withCorner(polygon) });
    },
    cancel: () => selecting.choose({ dragged: before }),
  };
}

/** A sphere around the splat at `from` that reaches to the pointer; a click keeps the radius. */
function sphereGesture(selecting: SplatSelecting, from: PicturePoint, space: PictureSpace): SelectGesture {
  let to = from;
  let isGoingOn = true;
  selecting.choose({ picked: null });
  const picking = selecting.centerAt(from[0] / space.width, from[1] / space.height);
  const radiusAround = (center: Vec3) => {
    const [rightPx, downPx] = [to[0] - from[0], to[1] - from[1]];
    if (Math.hypot(rightPx, downPx) <= MAX_WAY_PX) return selecting.sphereRadius;
    return selecting.radiusTo(center, space, rightPx, downPx);
  };
  const show = async () => {
    const center = await picking;
    if (center && isGoingOn)
      selecting.choose({ picked: { kind: 'sphere', center, radius: radiusAround(center) } });
  };
  return {
    move: (place) => {
      to = place;
      void show();
    },
    end: (mode) => {
      isGoingOn = false;
      void picking.then((center) => center && selecting.selectSphere(center, radiusAround(center), mode));
    },
    cancel: () => {
      isGoingOn = false;
      selecting.choose({ picked: null });
    },
  };
}
