import { type KeyboardEvent, type PointerEvent, useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import { SHEET_PARTS, settledSheet, sheetText, steppedSheet, toggledSheet } from '../state/sheet.ts';
import type { ViewerStore } from '../state/store.ts';
import { focusByPointer } from './pointer-focus.ts';

/** A pointer that moves less than this taps. */
const TAP_PX = 4;

interface Drag {
  readonly startY: number;
  readonly startPart: number;
  hasMoved: boolean;
  part: number;
  partsPerSecond: number;
  lastMs: number;
}

/** Changes the height of a sheet by a drag, a tap or keys; style sheets hide it on other panels. */
export function SheetGrip({ store, label }: { store: ViewerStore; label: string }) {
  const sheetPart = useStore(store, (state) => state.sheetPart);
  const drag = useRef<Drag | null>(null);
  useEffect(() => writePart(sheetPart), [sheetPart]);

  const onPointerDown = (event: PointerEvent<HTMLElement>) => {
    event.preventDefault();
    focusByPointer(event.currentTarget);
    event.currentTarget.setPointerCapture(event.pointerId);
    drag.current = {
      startY: event.clientY,
      startPart: sheetPart,
      hasMoved: false,
      part: sheetPart,
      partsPerSecond: 0,
      lastMs: event.timeStamp,
    };
  };
  const onPointerMove = (event: PointerEvent<HTMLElement>) => {
    const { current } = drag;
    if (!current) return;
    const upPx = current.startY - event.clientY;
    current.hasMoved ||= Math.abs(upPx) >= TAP_PX;
    if (!current.hasMoved) return;
    const part = current.startPart + upPx / window.innerHeight;
    const elapsedMs = event.timeStamp - current.lastMs;
    if (elapsedMs > 0) current.partsPerSecond = (1000 * (part - current.part)) / elapsedMs;
    Object.assign(current, { part, lastMs: event.timeStamp });
    dockOf(event.currentTarget)?.setAttribute('data-dragging', '');
    writePart(part);
  };
  const onPointerUp = (event: PointerEvent<HTMLElement>) => {
    const { current } = drag;
    if (!current) return;
    drag.current = null;
    dockOf(event.currentTarget)?.removeAttribute('data-dragging');
    const settled = current.hasMoved
      ? settledSheet(current.part, current.partsPerSecond)
      : toggledSheet(current.startPart);
    if (settled === null) store.setState({ dock: null });
    else store.setState({ sheetPart: settled });
    // Also where the state is as it was before the drag.
    writePart(settled ?? current.startPart);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const part =
      event.key === 'Enter' || event.key === ' '
        ? toggledSheet(sheetPart)
        : steppedSheet(sheetPart, event.key);
    if (part === null) return;
    event.preventDefault();
    store.setState({ sheetPart: part });
  };
  return (
    <div
      className="sheet-grip"
      role="slider"
      tabIndex={0}
      aria-label={label}
      aria-orientation="vertical"
      aria-valuemin={100 * SHEET_PARTS[0]}
      aria-valuemax={100 * SHEET_PARTS[SHEET_PARTS.length - 1]}
      aria-valuenow={Math.round(100 * sheetPart)}
      aria-valuetext={sheetText(sheetPart)}
      data-testid="sheet-grip"
      onPointerDown={onPointerDown}
      onPointerMove={onPointerMove}
      onPointerUp={onPointerUp}
      onPointerCancel={onPointerUp}
      onKeyDown={onKeyDown}
    />
  );
}

/** For style sheets, which place the split image above the sheet too. */
function writePart(part: number): void {
  document.documentElement.style.setProperty('--sheet-part', String(Math.max(0, part)));
}

function dockOf(element: HTMLElement): Element | null {
  return element.closest('.dock');
}
