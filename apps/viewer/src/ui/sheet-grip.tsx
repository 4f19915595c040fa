import { type KeyboardEvent, type PointerEvent, useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { focusByPointer } from './pointer-focus.ts';

/** Heights at which a sheet comes to rest, as fractions of the window's height, lowest first. */
export const SHEET_PARTS = [0.3, 0.5, 0.9] as const;

const NAMES = ['low', 'half', 'full'] as const;

/** A thrown sheet continues for this long, s. */
const THROW_S = 0.15;
/** A sheet released below this fraction of its lowest height closes. */
const CLOSING = 0.6;

/**
 * Height at which a sheet settles after release at `part`, growing by `partsPerSecond`; null: it
 * closes.
 */
export function settledSheet(part: number, partsPerSecond: number): number | null {
  const goal = part + partsPerSecond * THROW_S;
  if (goal < CLOSING * SHEET_PARTS[0]) return null;
  return SHEET_PARTS[sheetStep(goal)];
}

/** The height of a sheet after `key` is pressed on its grip; null if the key does not change it. */
export function steppedSheet(part: number, key: string): number | null {
  const at = sheetStep(part);
  const last = SHEET_PARTS.length - 1;
  const goals: Readonly<Record<string, number>> = {
    ArrowUp: at + 1,
    ArrowRight: at + 1,
    PageUp: at + 1,
    ArrowDown: at - 1,
    ArrowLeft: at - 1,
    PageDown: at - 1,
    Home: 0,
    End: last,
  };
  if (!Object.hasOwn(goals, key)) return null;
  return SHEET_PARTS[Math.min(last, Math.max(0, goals[key]))];
}

/** The next height, and the lowest after the highest: the effect of a tap on the grip. */
export function toggledSheet(part: number): number {
  return SHEET_PARTS[(sheetStep(part) + 1) % SHEET_PARTS.length];
}

/** Index of the nearest of `SHEET_PARTS`. */
function sheetStep(part: number): number {
  const distances = SHEET_PARTS.map((each) => Math.abs(each - part));
  return distances.indexOf(Math.min(...distances));
}

/** The height as text for screen readers. */
export function sheetText(part: number): string {
  return NAMES[sheetStep(part)];
}

/** Longest way of a tap; a pointer that moves further drags. */
const TAP_PX = 4;

interface Drag {
  readonly startY: number;
  readonly startPart: number;
  hasMoved: boolean;
  part: number;
  partsPerSecond: number;
  lastMs: number;
}

/** Changes the height of a sheet by drag, tap or key. Style sheets hide it on other panels. */
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
    // Also needed if the state equals the one before the drag.
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

/** Sets the property that style sheets use, which also place the split image above the sheet. */
function writePart(part: number): void {
  document.documentElement.style.setProperty('--sheet-part', String(Math.max(0, part)));
}

function dockOf(element: HTMLElement): Element | null {
  return element.closest('.dock');
}
