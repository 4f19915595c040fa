import type { ClipValues, OptionValues } from '@websplatter/core/effect-options';
import { useRef } from 'react';
import { useStore } from 'zustand';
import { pathInPicture, pictureOf } from '../camera/picture-space.ts';
import { pictureSpace, useHandle, useOverPicture } from '../engine/over-picture.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import { scenePlaceOf } from '../engine/scene-place.ts';
import type { RequestedEffects } from '../state/requested-effects.ts';
import type { Vec3 } from '../state/vec3.ts';
import { changeEffect } from './choose-effects.ts';
import { clipOutline } from './clip-outline.ts';
import { movedClip, stepOfKey } from './move-clip.ts';

const HOW: Readonly<Record<ClipValues['shape'], string>> = {
  plane: 'arrow keys move it to and fro',
  box: 'arrow keys move it in the picture, Page Up and Page Down in depth',
  sphere: 'arrow keys move it in the picture, Page Up and Page Down in depth',
};

/** The clip's outline over the picture, and its handle. It follows the camera without React. */
export function ClipGizmo({ store, viewer }: PanelProps) {
  const root = useRef<HTMLDivElement>(null);
  const handle = useRef<HTMLButtonElement>(null);
  const shape = useStore(store, ({ requested }) => clipIn(requested)?.shape ?? 'plane');

  useOverPicture(store, () => {
    const clip = clipIn(store.getState().requested);
    const space = pictureSpace(viewer, root.current);
    if (!clip || !space || !handle.current) return;
    const path = pathInPicture(space, clipOutline(clip, scenePlaceOf(viewer).radius));
    for (const line of root.current?.querySelectorAll('path') ?? []) line.setAttribute('d', path);
    const place = pictureOf(space, clip.center);
    handle.current.style.visibility = place ? 'visible' : 'hidden';
    if (place) handle.current.style.translate = `${place[0]}px ${place[1]}px`;
  });

  /** Moves the clip from `center` by CSS pixels to the right, down and away. */
  const moveFrom = (center: Vec3 | null, ...byPx: Vec3) => {
    const space = pictureSpace(viewer, root.current);
    if (!space) return;
    changeEffect({ store, viewer }, 'clip', (values) => {
      const from = center ? { ...values, center } : values;
      return movedClip(space, from as ClipValues & OptionValues, byPx, scenePlaceOf(viewer).radius);
    });
  };
  const listeners = useHandle({
    grip: (from) => {
      const center = clipIn(store.getState().requested)?.center;
      return center ? { center, from } : null;
    },
    drag: ({ center, from }, at) => moveFrom(center, at[0] - from[0], at[1] - from[1], 0),
    step: (key, isLarge) => {
      const stepPx = stepOfKey(key, isLarge);
      if (stepPx) moveFrom(null, ...stepPx);
      return stepPx !== null;
    },
  });
  return (
    <div ref={root} className="over-picture clip-gizmo" data-testid="clip-gizmo">
      <svg className="over-picture" aria-hidden="true">
        <path />
        <path />
      </svg>
      <button
        {...listeners}
        ref={handle}
        type="button"
        className="clip-handle"
        aria-label={`Move the ${shape} of the clip: ${HOW[shape]}`}
        data-testid="clip-handle"
      />
    </div>
  );
}

function clipIn({ choices }: RequestedEffects): ClipValues | undefined {
  return choices.clip?.values as ClipValues | undefined;
}
