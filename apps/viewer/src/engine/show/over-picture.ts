import { type KeyboardEvent, type PointerEvent, useEffect, useRef } from 'react';
import { shallow } from 'zustand/vanilla/shallow';
import type { PicturePoint, PictureSpace } from '../../camera/picture-space.ts';
import type { ViewerStore } from '../../state/store.ts';
import { focusByPointer } from '../../ui/pointer-focus.ts';
import type { Viewer } from '../viewer.ts';

/** State whose changes move the picture or its overlays. */
const SHOWN = ['shownFrames', 'widthPx', 'heightPx', 'scene', 'requested', 'inspecting'] as const;

/**
 * Calls `write` whenever overlays must be placed anew: they follow the frames on the screen without
 * a React render.
 */
export function useOverPicture(store: ViewerStore, write: () => void): void {
  useEffect(() => {
    write();
    return store.subscribe((state) => SHOWN.map((key) => state[key]), write, { equalityFn: shallow });
  });
}

/** Camera of the frame on the screen, and size of the picture; null before the first frame. */
export function pictureSpace(
  { shownFrame }: Pick<Viewer, 'shownFrame'>,
  over: Element | null,
): PictureSpace | null {
  if (!shownFrame || !over) return null;
  return { camera: shownFrame.frame.camera, width: over.clientWidth, height: over.clientHeight };
}

/** How drags and keys move a handle over the picture. */
export interface HandleMoves<Grip> {
  /** State at the start of a drag from this point; null if no drag can start there. */
  readonly grip: (at: PicturePoint) => Grip | null;
  readonly drag: (grip: Grip, at: PicturePoint) => void;
  /**
   * Returns whether the key moves the handle.
   *
   * @param hold the same object while the key is held, which repeats it.
   */
  readonly step: (key: string, isLarge: boolean, hold: object) => boolean;
}

/** Pointer and key listeners for a handle over the picture. */
export function useHandle<Grip>({ grip, drag, step }: HandleMoves<Grip>) {
  const held = useRef<Grip | null>(null);
  const hold = useRef<object>({});
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
      if (!event.repeat) hold.current = {};
      const hasModifier = event.ctrlKey || event.metaKey || event.altKey;
      if (hasModifier || !step(event.key, event.shiftKey, hold.current)) return;
      event.preventDefault();
      // Arrow keys that bubble would turn the scene.
      event.stopPropagation();
    },
  };
}

/** The pointer's position; the picture fills the window. */
export function placeOf({ clientX, clientY }: Pick<MouseEvent, 'clientX' | 'clientY'>): PicturePoint {
  return [clientX, clientY];
}
