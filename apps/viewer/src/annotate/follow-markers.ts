import { shallow } from 'zustand/vanilla/shallow';
import { flippedPoint } from '../camera/flip.ts';
import { type PicturePoint, pictureOf } from '../camera/picture-space.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import type { Vec3 } from '../state/vec3.ts';

/**
 * Splats hide a marker if they are nearer by more than this fraction of its depth: splats of one
 * surface differ by less.
 */
const NEARER_PART = 0.03;
/** Opacity of all splats in front of a marker from which it counts as hidden. */
const HIDING_OPACITY = 0.5;

/** The members of `HTMLElement` that markers use. */
export interface MarkerElement {
  readonly style: Pick<CSSStyleDeclaration, 'translate'>;
  toggleAttribute(name: string, isOn?: boolean): boolean;
}

/** A position in the picture, CSS pixels. */
interface SeenPlace {
  readonly at: PicturePoint;
  readonly world: Vec3;
  /** View depth, world units. */
  readonly depth: number;
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
  const placeOf = (point: Vec3): SeenPlace | null => {
    const { shownFrame } = viewer;
    if (!shownFrame) return null;
    const { camera } = shownFrame.frame;
    const { width, height } = sizeOf();
    const world = shownFrame.isFlipped ? flippedPoint(point) : point;
    const at = pictureOf({ camera, width, height }, world);
    if (!at || at[0] < 0 || at[0] >= width || at[1] < 0 || at[1] >= height) return null;
    const { viewMatrix: m } = camera;
    return { at, world, depth: -(m[2] * world[0] + m[6] * world[1] + m[10] * world[2] + m[14]) };
  };
  const write = () => {
    for (const [i, marker] of markers.entries()) {
      const place = placeOf(points[i]);
      marker.toggleAttribute('hidden', place === null);
      if (place) marker.style.translate = `${place.at[0].toFixed(1)}px ${place.at[1].toFixed(1)}px`;
    }
  };
  const check = async () => {
    const own = ++checks;
    const inPicture = markers.flatMap((marker, i) => {
      const place = placeOf(points[i]);
      return place ? [{ marker, ...place }] : [];
    });
    if (inPicture.length === 0) return;
    const asked = inPicture.map(({ world, depth }) => ({ point: world, tolerance: NEARER_PART * depth }));
    const covered = await viewer.askShown((view) => view.coverage(asked));
    if (!covered || own !== checks) return;
    for (const [i, { marker }] of inPicture.entries())
      marker.toggleAttribute('data-behind', covered[i].opacity > HIDING_OPACITY);
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
