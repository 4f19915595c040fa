import type { ClipValues, OptionValues } from '@websplatter/core/effect-options';
import { type KeyboardEvent, type PointerEvent, useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import { type PictureSpace, pathInPicture, pictureOf } from '../camera/picture-space.ts';
import type { Vec3 } from '../camera/vec3.ts';
import type { RequestedEffects } from '../state/requested-effects.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import type { Viewer } from '../viewer/viewer.ts';
import { changeEffect } from './choose-effects.ts';
import { clipOutline } from './clip-outline.ts';
import { movedClip, stepOfKey } from './move-clip.ts';
import { scenePlaceOf } from './scene-place.ts';

const HOW: Readonly<Record<ClipValues['shape'], string>> = {
  plane: 'arrow keys move it to and fro',
  box: 'arrow keys move it in the picture, Page Up and Page Down in depth',
  sphere: 'arrow keys move it in the picture, Page Up and Page Down in depth',
};

/** The clip's outline over the picture, and its handle. It follows the camera without React. */
export function ClipGizmo({ store, viewer }: PanelProps) {
  const root = useRef<HTMLDivElement>(null);
  const handle = useRef<HTMLButtonElement>(null);
  const drag = useRef<{ readonly center: Vec3; readonly x: number; readonly y: number } | null>(null);
  const shape = useStore(store, ({ requested }) => clipIn(requested)?.shape ?? 'plane');

  useEffect(() => {
    const write = () => {
      const clip = clipIn(store.getState().requested);
      const space = root.current && pictureSpace(root.current, viewer);
      if (!clip || !space || !handle.current) return;
      const path = pathInPicture(space, clipOutline(clip, scenePlaceOf(viewer).radius));
      for (const line of root.current?.querySelectorAll('path') ?? []) line.setAttribute('d', path);
      const place = pictureOf(space, clip.center);
      handle.current.style.visibility = place ? 'visible' : 'hidden';
      if (place) handle.current.style.translate = `${place[0]}px ${place[1]}px`;
    };
    write();
    return store.subscribe((state, before) => {
      const isMoved = state.lastRender !== before.lastRender || state.requested !== before.requested;
      if (isMoved || state.widthPx !== before.widthPx || state.heightPx !== before.heightPx) write();
    });
  }, [store, viewer]);

  /** Moves the clip from `center` by CSS pixels to the right, down and away. */
  const moveFrom = (center: Vec3 | null, ...byPx: Vec3) => {
    const space = root.current && pictureSpace(root.current, viewer);
    if (!space) return;
    changeEffect({ store, viewer }, 'clip', (values) => {
      const from = center ? { ...values, center } : values;
      return movedClip(space, from as ClipValues & OptionValues, byPx, scenePlaceOf(viewer).radius);
    });
  };
  const onPointerDown = (event: PointerEvent) => {
    const clip = clipIn(store.getState().requested);
    if (!clip || !handle.current) return;
    drag.current = { center: clip.center, x: event.clientX, y: event.clientY };
    event.currentTarget.setPointerCapture(event.pointerId);
    event.preventDefault();
    focusByPointer(handle.current);
  };
  const onPointerMove = (event: PointerEvent) => {
    const from = drag.current;
    if (!from || !event.currentTarget.hasPointerCapture(event.pointerId)) return;
    moveFrom(from.center, event.clientX - from.x, event.clientY - from.y, 0);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const stepPx = stepOfKey(event.key, event.shiftKey);
    if (!stepPx) return;
    event.preventDefault();
    // Arrows elsewhere turn the scene.
    event.stopPropagation();
    moveFrom(null, ...stepPx);
  };
  return (
    <div ref={root} className="over-picture clip-gizmo" data-testid="clip-gizmo">
      <svg className="over-picture" aria-hidden="true">
        <path />
        <path />
      </svg>
      <button
        ref={handle}
        type="button"
        className="clip-handle"
        aria-label={`Move the ${shape} of the clip: ${HOW[shape]}`}
        data-testid="clip-handle"
        onPointerDown={onPointerDown}
        onPointerMove={onPointerMove}
        onKeyDown={onKeyDown}
      />
    </div>
  );
}

function clipIn({ choices }: RequestedEffects): ClipValues | undefined {
  return choices.clip?.values as ClipValues | undefined;
}

/** The picture on the screen; null before there is one. */
function pictureSpace(root: HTMLElement, { shownFrame }: Viewer): PictureSpace | null {
  if (!shownFrame) return null;
  return { camera: shownFrame.frame.camera, width: root.clientWidth, height: root.clientHeight };
}
