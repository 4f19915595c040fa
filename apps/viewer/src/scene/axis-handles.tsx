import { roundedTo } from '@websplatter/kit/nice-steps';
import { useRef } from 'react';
import { flippedPoint } from '../camera/flip.ts';
import { pictureSpace, useHandle, useOverPicture } from '../engine/show/over-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { clamp, scale, UNIT_AXES, type Vec3 } from '../state/vec3.ts';
import { distanceAlong, seenAxis } from './axis-layout.ts';

/** Steps per key press with Shift. */
const LARGE_STEP = 10;
/**
 * Half the size of a handle; handles keep this distance from panels and from the picture's edges.
 */
const HALF_PX = 22;
const DIRECTIONS: Readonly<Record<string, number>> = {
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
};

/** A handle that moves a value along an axis of the scene. */
export interface AxisHandle {
  /** 0 for x, 1 for y, 2 for z. */
  readonly axis: number;
  /** Direction of the handle's arm along the axis. */
  readonly side: 1 | -1;
  readonly label: string;
  readonly testId: string;
}

/** Start of a handle's arm, in the scene's own space, and the value that the handle moves. */
export interface HandlePlace {
  readonly foot: Vec3;
  /** Scene units along the handle's axis. */
  readonly value: number;
}

interface AxisHandlesProps<Handle extends AxisHandle> extends PanelProps {
  readonly handles: readonly Handle[];
  /** Length of an arm perpendicular to the view direction. */
  readonly armPx: number;
  readonly testId: string;
  readonly placeOf: (handle: Handle) => HandlePlace;
  /** Scene units per key press; drags are rounded to a tenth of it. */
  readonly step: number;
  /** @param gesture the same object during a whole drag, or while a key is held. */
  readonly onMove: (handle: Handle, value: number, gesture: object) => void;
}

/** Handles on arms over the picture. Pointers and keys move each along its axis. */
export function AxisHandles<Handle extends AxisHandle>(props: AxisHandlesProps<Handle>) {
  const { store, viewer, handles, armPx, testId, step, placeOf } = props;
  const root = useRef<HTMLDivElement>(null);
  /** From the scene's own space to the camera's world. */
  const seen = (point: Vec3) => (viewer.shownFrame?.isFlipped ? flippedPoint(point) : point);

  useOverPicture(store, () => {
    const space = pictureSpace(viewer, root.current);
    if (!root.current || !space) return;
    const arms = root.current.querySelectorAll('g');
    for (const [i, element] of root.current.querySelectorAll<HTMLElement>('.axis-handle').entries()) {
      const { axis, side } = handles[i];
      const place = placeOf(handles[i]);
      const arm = seenAxis(space, seen(place.foot), seen(scale(UNIT_AXES[axis], side)), armPx);
      for (const each of [element, arms[i]]) each.toggleAttribute('hidden', !arm?.canDrag);
      const value = String(roundedTo(place.value, step / 10));
      element.setAttribute('aria-valuenow', value);
      element.setAttribute('aria-valuetext', `${value} scene units`);
      if (!arm) continue;
      const { from, to } = arm;
      const { left, right, top, bottom } = viewer.camera.covered;
      const x = clamp(to[0], left * space.width + HALF_PX, (1 - right) * space.width - HALF_PX);
      const y = clamp(to[1], top * space.height + HALF_PX, (1 - bottom) * space.height - HALF_PX);
      element.style.translate = `${x}px ${y}px`;
      for (const line of arms[i].children)
        for (const [name, px] of Object.entries({ x1: from[0], y1: from[1], x2: to[0], y2: to[1] }))
          line.setAttribute(name, String(px));
    }
  });
  return (
    <div ref={root} className="over-picture axis-handles" data-testid={testId}>
      <svg className="over-picture" aria-hidden="true">
        {handles.map(({ axis, testId: id }) => (
          <g key={id} className={`axis-${'xyz'[axis]}`}>
            <line className="arm-edge" />
            <line />
          </g>
        ))}
      </svg>
      {handles.map((handle) => (
        <OneHandle
          key={handle.testId}
          {...props}
          handle={handle}
          distanceTo={(at, foot) => {
            const space = pictureSpace(viewer, root.current);
            return space && distanceAlong(space, seen(foot), seen(UNIT_AXES[handle.axis]), at);
          }}
        />
      ))}
    </div>
  );
}

interface OneHandleProps<Handle extends AxisHandle> extends AxisHandlesProps<Handle> {
  readonly handle: Handle;
  /**
   * Distance along the axis from `foot` to a point of the picture; null if the axis points at the
   * viewer.
   */
  readonly distanceTo: (at: readonly [number, number], foot: Vec3) => number | null;
}

function OneHandle<Handle extends AxisHandle>({
  handle,
  distanceTo,
  placeOf,
  step,
  onMove,
}: OneHandleProps<Handle>) {
  const listeners = useHandle({
    grip: (at) => {
      const place = placeOf(handle);
      const from = distanceTo(at, place.foot);
      return from !== null ? { ...place, from } : null;
    },
    drag: (grip, at) => {
      const distance = distanceTo(at, grip.foot);
      if (distance === null) return;
      onMove(handle, roundedTo(grip.value + distance - grip.from, step / 10), grip);
    },
    step: (key, isLarge, hold) => {
      const direction = DIRECTIONS[key];
      if (!direction) return false;
      const by = direction * step * (isLarge ? LARGE_STEP : 1);
      onMove(handle, roundedTo(placeOf(handle).value + by, step / 10), hold);
      return true;
    },
  });
  const name = 'xyz'[handle.axis];
  return (
    <div
      {...listeners}
      className={`axis-handle axis-${name}`}
      role="spinbutton"
      tabIndex={0}
      aria-label={handle.label}
      aria-valuenow={0}
      data-testid={handle.testId}
    >
      <span>{name}</span>
    </div>
  );
}
