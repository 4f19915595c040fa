import { shallow } from 'zustand/vanilla/shallow';
import { flippedPoint } from '../camera/flip.ts';
import { hiddenPoints } from '../camera/hidden-points.ts';
import { type PicturePoint, pictureOf } from '../camera/picture-space.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import type { Vec3 } from '../state/vec3.ts';

/** The members of `HTMLElement` that markers use. */
export interface MarkerElement {
  readonly style: Pick<CSSStyleDeclaration, 'translate'>;
  toggleAttribute(name: string, isOn?: boolean): boolean;
}

/**
 * Keeps markers at the picture positions of their scene points, and hides markers outside of the
 * picture (`hidden`). At rest, `data-behind` marks points behind splats. Returns a function that
 * stops this.
 */
export function followMarkers(
  { store, viewer }: PanelProps,
  markers: readonly MarkerElement[],
  points: readonly Vec3[],
  sizeOf: () => { readonly width: number; readonly height: number },
): () => void {
  let checks = 0;
  const placeOf = (point: Vec3): PicturePoint | null => {
    const { shownFrame } = viewer;
    if (!shownFrame) return null;
    const { camera } = shownFrame.frame;
    const { width, height } = sizeOf();
    const at = pictureOf({ camera, width, height }, shownFrame.isFlipped ? flippedPoint(point) : point);
    return at && at[0] >= 0 && at[0] < width && at[1] >= 0 && at[1] < height ? at : null;
  };
  const write = () => {
    for (const [i, marker] of markers.entries()) {
      const place = placeOf(points[i]);
      marker.toggleAttribute('hidden', place === null);
      if (place) marker.style.translate = `${place[0].toFixed(1)}px ${place[1].toFixed(1)}px`;
    }
  };
  const check = async () => {
    const own = ++checks;
    const hidden = await hiddenPoints(viewer, points);
    if (own !== checks) return;
    for (const [i, isHidden] of hidden?.entries() ?? [])
      if (isHidden !== null) markers[i].toggleAttribute('data-behind', isHidden);
  };
  write();
  if (store.getState().isIdle) void check();
  const stops = [
    store.subscribe(({ shownFrames, restedFrames }) => [shownFrames, restedFrames], write, {
      equalityFn: shallow,
    }),
    store.subscribe(({ restedFrames }) => restedFrames, check),
  ];
  return () => {
    checks++;
    for (const stop of stops) stop();
  };
}
