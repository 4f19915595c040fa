import { type KeyboardEvent, type PointerEvent, useEffect, useRef } from 'react';
import { shallow } from 'zustand/vanilla/shallow';
import type { PicturePoint, PictureSpace } from '../camera/picture-space.ts';
import type { ViewerStore } from '../state/store.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';
import type { Viewer } from './viewer.ts';

/** States that change the picture, or what lies over it. */
const SHOWN = ['lastRender', 'widthPx', 'heightPx', 'scene', 'requested', 'inspecting'] as const;

/** Calls `write`, which places things over the picture: they follow the camera without React. */
export function useOverPicture(store: ViewerStore, write: () => void): void {
  useEffect(() => {
    write();
    return store.subscribe((state) => SHOWN.map((key) => state[key]), write, { equalityFn: shallow });
  });
}

/** The picture on the screen; null before there is one. */
export function pictureSpace(
  { shownFrame }: Pick<Viewer, 'shownFrame'>,
  over: Element | null,
): PictureSpace | null {
  if (!shownFrame || !over) return null;
  return { camera: shownFrame.frame.camera, width: over.clientWidth, height: over.clientHeight };
}

/** What moves a handle. */
export interface HandleMoves<Grip> {
  /** What a drag from this place begins with; null where none can begin. */
  readonly grip: (at: PicturePoint) => Grip | null;
  readonly drag: (grip: Grip, at: PicturePoint) => void;
  /** Returns whether the key moves it. */
  readonly step: (key: string, isLarge: boolean) => boolean;
}

/** Listeners of a handle over the picture, for pointers and keys. */
export function useHandle<Grip>({ grip, drag, step }: HandleMoves<Grip>) {
  const held = useRef<Grip | null>(null);
  const end = () => {
    held.current = null;
  };
  return {
    onPointerDown: (event: PointerEvent<HTMLElement>) => {
      event.preventDefault();
      focusByPointer(event.currentTarget);
      event.currentTarget.setPointerCapture(event.pointerId);
      held.current = grip(placeOf(event));
    },
    onPointerMove: (event: PointerEvent) => {
      if (held.current !== null) drag(held.current, placeOf(event));
    },
    onPointerUp: end,
    onPointerCancel: end,
    onKeyDown: (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !step(event.key, event.shiftKey)) return;
      event.preventDefault();
      // Arrows elsewhere turn the scene.
      event.stopPropagation();
    },
  };
}

/** The picture fills the window. */
export function placeOf({ clientX, clientY }: Pick<MouseEvent, 'clientX' | 'clientY'>): PicturePoint {
  return [clientX, clientY];
}
