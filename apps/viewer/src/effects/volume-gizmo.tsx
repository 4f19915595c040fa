import { type OptionValues, planeNormal, type VolumeValues } from '@websplatter/core/effect-options';
import { roundedTo, stepFor } from '@websplatter/kit/nice-steps';
import { useRef } from 'react';
import { useStore } from 'zustand';
import {
  boxOutline,
  circleOutline,
  movedAlong,
  movedAway,
  movedInPicture,
  type Outline,
  type PictureSpace,
  pathInPicture,
  pictureOf,
} from '../camera/picture-space.ts';
import { pictureSpace, useHandle, useOverPicture } from '../engine/show/over-picture.ts';
import { scenePlaceOf } from '../engine/show/scene-place.ts';
import type { PanelProps } from '../engine/viewer.ts';
import type { RequestedEffects } from '../state/effects.ts';
import { add, cross, normalize, scale, subtract, UNIT_AXES, type Vec3 } from '../state/vec3.ts';
import { changeEffect } from './choose-effects.ts';

/** CSS pixels per key press. */
const STEP_PX = 8;
const LARGE_STEP_PX = 40;
/** Positions are rounded to a tenth of a slider's step. */
const EXACTNESS = 0.1;

const DIRECTIONS: Readonly<Record<string, Vec3>> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, -1, 0],
  ArrowDown: [0, 1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

/** CSS pixels by which a key moves its handle: right, down and away; null for other keys. */
export function stepOfKey(key: string, isLarge: boolean): Vec3 | null {
  const direction = DIRECTIONS[key];
  const px = isLarge ? LARGE_STEP_PX : STEP_PX;
  return direction ? [direction[0] * px, direction[1] * px, direction[2] * px] : null;
}

/**
 * Moves a volume in the picture by CSS pixels right, down and away; planes move along their
 * normal.
 */
export function movedVolume<Values extends VolumeValues>(
  space: PictureSpace,
  values: Values,
  [rightPx, downPx, awayPx]: Vec3,
  sceneRadius: number,
): Values {
  const { shape, center } = values;
  const moved =
    shape === 'plane'
      ? movedAlong(space, center, planeNormal(values), rightPx, downPx)
      : movedAway(space, movedInPicture(space, center, rightPx, downPx), awayPx);
  const step = EXACTNESS * stepFor(sceneRadius);
  return {
    ...values,
    center: [roundedTo(moved[0], step), roundedTo(moved[1], step), roundedTo(moved[2], step)],
  };
}

/**
 * Lines of a volume: the edges of a box, three circles of a sphere, or a square in a plane.
 *
 * @param planeRadius half the length of the square.
 */
export function volumeOutline(values: VolumeValues, planeRadius: number): Outline {
  const { shape, center } = values;
  if (shape === 'box') {
    const half = scale(values.size, 0.5);
    return boxOutline(subtract(center, half), add(center, half));
  }
  if (shape === 'sphere') return AXIS_PAIRS.map(([u, v]) => circleOutline(center, u, v, values.radius));
  return planeOutline(center, planeNormal(values), planeRadius, values.mode === 'keep' ? 1 : -1);
}

const [X, Y, Z] = UNIT_AXES;
const AXIS_PAIRS = [
  [X, Y],
  [Y, Z],
  [Z, X],
] as const;

/** A square, and a line from its centre to the side that is kept. */
function planeOutline(center: Vec3, normal: Vec3, radius: number, side: 1 | -1): Outline {
  const u = normalize(cross(Math.abs(normal[1]) > 0.9 ? X : Y, normal));
  const v = cross(normal, u);
  const corner = (a: number, b: number) => add(center, add(scale(u, a * radius), scale(v, b * radius)));
  return [
    [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1), corner(-1, -1)],
    [center, add(center, scale(normal, (side * radius) / 3))],
  ];
}

const HOW: Readonly<Record<VolumeValues['shape'], string>> = {
  plane: 'arrow keys move it to and fro',
  box: 'arrow keys move it in the picture, Page Up and Page Down in depth',
  sphere: 'arrow keys move it in the picture, Page Up and Page Down in depth',
};

/**
 * The volume's outline over the picture, and its handle. Follows the camera without a React render.
 */
export function VolumeGizmo({ store, viewer }: PanelProps) {
  const root = useRef<HTMLDivElement>(null);
  const handle = useRef<HTMLButtonElement>(null);
  const shape = useStore(store, ({ requested }) => volumeIn(requested)?.shape ?? 'plane');

  useOverPicture(store, () => {
    const volume = volumeIn(store.getState().requested);
    const space = pictureSpace(viewer, root.current);
    if (!volume || !space || !handle.current) return;
    const path = pathInPicture(space, volumeOutline(volume, scenePlaceOf(viewer).radius));
    for (const line of root.current?.querySelectorAll('path') ?? []) line.setAttribute('d', path);
    const place = pictureOf(space, volume.center);
    handle.current.style.visibility = place ? 'visible' : 'hidden';
    if (place) handle.current.style.translate = `${place[0]}px ${place[1]}px`;
  });

  /** Moves the volume from `center` by CSS pixels right, down and away. */
  const moveFrom = (center: Vec3 | null, gesture: object, ...byPx: Vec3) => {
    const space = pictureSpace(viewer, root.current);
    if (!space) return;
    const moved = (values: OptionValues) => {
      const from = center ? { ...values, center } : values;
      return movedVolume(space, from as VolumeValues & OptionValues, byPx, scenePlaceOf(viewer).radius);
    };
    changeEffect({ store, viewer }, 'volumes', moved, gesture);
  };
  const listeners = useHandle({
    grip: (from) => {
      const center = volumeIn(store.getState().requested)?.center;
      return center ? { center, from } : null;
    },
    drag: (grip, at) => moveFrom(grip.center, grip, at[0] - grip.from[0], at[1] - grip.from[1], 0),
    step: (key, isLarge, hold) => {
      const stepPx = stepOfKey(key, isLarge);
      if (stepPx) moveFrom(null, hold, ...stepPx);
      return stepPx !== null;
    },
  });
  return (
    <div ref={root} className="over-picture volume-gizmo" data-testid="volume-gizmo">
      <svg className="over-picture" aria-hidden="true">
        <path />
        <path />
      </svg>
      <button
        {...listeners}
        ref={handle}
        type="button"
        className="volume-handle"
        aria-label={`Move the ${shape}: ${HOW[shape]}`}
        data-testid="volume-handle"
      />
    </div>
  );
}

function volumeIn({ choices }: RequestedEffects): VolumeValues | undefined {
  return choices.volumes?.values as VolumeValues | undefined;
}
