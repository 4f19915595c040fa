import { useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import { Tap } from '../camera/tap.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import { annotationTitle } from '../state/annotating.ts';
import { openAnnotation, placeAnnotation } from './annotations.ts';
import { followMarkers } from './follow-markers.ts';

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
