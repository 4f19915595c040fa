import { useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import { shallow } from 'zustand/vanilla/shallow';
import { flippedPoint } from '../camera/flip.ts';
import { type PicturePoint, pictureOf } from '../camera/picture-space.ts';
import { Tap } from '../camera/tap.ts';
import { hiddenPoints } from '../engine/show/hidden-points.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { annotationTitle } from '../state/annotating.ts';
import type { Vec3 } from '../state/vec3.ts';
import { openAnnotation, placeAnnotation } from './annotations.ts';

/** Numbered markers over the picture; while placing, a click adds an annotation. */
export function AnnotationMarkers({ store, viewer }: PanelProps) {
  const root = useRef<HTMLDivElement>(null);
  const list = useStore(store, (state) => state.annotating.list);
  const openIndex = useStore(store, (state) => state.annotating.openIndex);
  useEffect(() => {
    const element = root.current;
    if (!element) return;
    const size = () => ({ width: element.clientWidth, height: element.clientHeight });
    const markers = [...element.querySelectorAll('button')];
    return followMarkers(
      { store, viewer },
      markers,
      list.map(({ point }) => point),
      size,
    );
  }, [store, viewer, list]);
  useEffect(() => listenToPlacing({ store, viewer }), [store, viewer]);
  return (
    <div ref={root} className="over-picture annotation-markers">
      {list.map((annotation, i) => (
        <button
          // biome-ignore lint/suspicious/noArrayIndexKey: the marker shows its index.
          key={i}
          type="button"
          className="annotation-marker"
          title={annotationTitle(annotation, i)}
          aria-label={`${i + 1}: ${annotationTitle(annotation, i)}`}
          aria-expanded={i === openIndex}
          data-testid={`annotation-${i + 1}`}
          onClick={() => openAnnotation({ store, viewer }, i === openIndex ? null : i)}
        >
          <span>{i + 1}</span>
        </button>
      ))}
    </div>
  );
}

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

/** Handles clicks that place an annotation; returns a function that stops this. */
function listenToPlacing(panel: PanelProps): () => void {
  const { store } = panel;
  const listeners = new AbortController();
  const { signal } = listeners;
  const tap = new Tap();
  const isPlacing = ({ target, isPrimary, button }: PointerEvent) =>
    store.getState().annotating.isPlacing &&
    isPrimary &&
    button === 0 &&
    target instanceof HTMLElement &&
    target.matches('.viewport');
  const onPointerUp = (event: PointerEvent) => {
    if (!tap.pointerUp(event) || !(event.target instanceof HTMLElement)) return;
    const { clientWidth, clientHeight } = event.target;
    void placeAnnotation(panel, event.offsetX / clientWidth, event.offsetY / clientHeight);
  };
  addEventListener('pointerdown', (event) => tap.pointerDown(event, isPlacing(event)), { signal });
  addEventListener('pointerup', onPointerUp, { signal });
  return () => listeners.abort();
}
