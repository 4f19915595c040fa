import { type KeyboardEvent, type PointerEvent, useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { type Comparison, sideDrawn } from '../state/comparison.ts';
import { describeDrawn } from '../ui/detail-words.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';

/** Parts of the width by which a key moves the line. */
const STEP = 0.01;
const LARGE_STEP = 0.1;

/** The line's position after a key press at `part` (0…1 of the width); null for other keys. */
export function movedSplit(part: number, key: string, isShift: boolean): number | null {
  const step = isShift ? LARGE_STEP : STEP;
  const goals: Readonly<Record<string, number>> = {
    ArrowLeft: part - step,
    ArrowDown: part - step,
    ArrowRight: part + step,
    ArrowUp: part + step,
    PageDown: part - LARGE_STEP,
    PageUp: part + LARGE_STEP,
    Home: 0,
    End: 1,
  };
  if (!Object.hasOwn(goals, key)) return null;
  // Rounded, so that steps there and back meet.
  return Math.min(1, Math.max(0, Math.round(1000 * goals[key]) / 1000));
}

/** The position of the line as a screen reader reads it out. */
export function splitText(part: number, left: string, right: string): string {
  const percent = Math.round(100 * part);
  return `${percent} % ${left}, ${100 - percent} % ${right}`;
}

/** The right side of a split image over the viewer's canvas, and the line between both sides. */
export function SplitImage({
  store,
  viewer,
  split,
}: PanelProps & { split: Extract<Comparison, { kind: 'split' }> }) {
  const root = useRef<HTMLDivElement>(null);
  const area = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const line = useRef<HTMLDivElement>(null);
  const left = useStore(store, (state) => describeDrawn(sideDrawn(split.left, state)));
  const right = useStore(store, (state) => describeDrawn(sideDrawn(split.right, state)));

  useEffect(() => (canvas.current ? viewer.attachRight(canvas.current) : undefined), [viewer]);
  // The line follows a hand: React does not render each step.
  useEffect(() => {
    const write = () => {
      const { splitPart } = store.getState();
      root.current?.style.setProperty('--split', String(splitPart));
      line.current?.setAttribute('aria-valuenow', String(Math.round(100 * splitPart)));
      line.current?.setAttribute('aria-valuetext', splitText(splitPart, left, right));
    };
    write();
    return store.subscribe((state) => state.splitPart, write);
  }, [store, left, right]);

  const onPointerMove = (event: PointerEvent) => {
    if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
    const box = area.current?.getBoundingClientRect();
    if (box) store.setState({ splitPart: Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)) });
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const splitPart = movedSplit(store.getState().splitPart, event.key, event.shiftKey);
    if (splitPart === null) return;
    event.preventDefault();
    // Arrows elsewhere turn the scene.
    event.stopPropagation();
    store.setState({ splitPart });
  };
  return (
    <div ref={root} className="split" data-testid="split">
      <canvas ref={canvas} className="over-picture split-right" data-testid="split-right" />
      <div ref={area} className="split-area">
        <div
          ref={line}
          className="split-line"
          role="slider"
          tabIndex={0}
          aria-label="Line between the pictures"
          aria-orientation="horizontal"
          aria-valuemin={0}
          aria-valuemax={100}
          aria-valuenow={50}
          data-testid="split-line"
          onPointerDown={(event) => {
            event.currentTarget.setPointerCapture(event.pointerId);
            event.preventDefault();
            focusByPointer(event.currentTarget);
          }}
          onPointerMove={onPointerMove}
          onKeyDown={onKeyDown}
        >
          <span className="split-label left" data-testid="split-label-left">
            <span>
              <b>A</b> {left}
            </span>
          </span>
          <i className="split-handle" aria-hidden="true" />
          <span className="split-label right" data-testid="split-label-right">
            <span>
              <b>B</b> {right}
            </span>
          </span>
        </div>
      </div>
    </div>
  );
}
