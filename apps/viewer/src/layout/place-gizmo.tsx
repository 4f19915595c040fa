import { type KeyboardEvent, type PointerEvent, useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import { flippedPoint } from '../camera/flip.ts';
import type { PictureSpace } from '../camera/picture-space.ts';
import type { Vec3 } from '../camera/vec3.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import type { Viewer } from '../viewer/viewer.ts';
import { distanceAlong, seenAxes } from './gizmo-layout.ts';
import { movePart, moveStep, roundedMove } from './move-part.ts';
import { placedMiddle, placementOf } from './placement.ts';
import { selectedPartOf } from './selected-part.ts';

const AXES = ['x', 'y', 'z'] as const;
const UNIT_AXES: readonly Vec3[] = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];
/** Of an axis that lies across the view. */
const AXIS_LENGTH_PX = 84;
/** With Shift, keys go so many steps at once. */
const LARGE_STEP = 10;

/** The axis that is being dragged, and where it was taken. */
interface Drag {
  readonly axis: number;
  /** The middle of the file then, in the scene. */
  readonly middle: Vec3;
  readonly move: number;
  readonly grip: number;
}

/** Three handles over the picture that move the chosen file along the scene's axes. */
export function PlaceGizmo({ store, viewer }: PanelProps) {
  const root = useRef<HTMLDivElement>(null);
  const drag = useRef<Drag | null>(null);
  const key = useStore(store, (state) => {
    const part = selectedPartOf(state);
    return part?.canPlace && !part.look.isHidden ? part.key : null;
  });
  const title = useStore(store, (state) => selectedPartOf(state)?.title);

  // The handles follow the camera: React does not render each step.
  useEffect(() => {
    if (key === null) return;
    const write = () => writeGizmo(root.current, viewer, store.getState());
    write();
    return store.subscribe((state, before) => {
      const hasMoved =
        state.lastRender !== before.lastRender ||
        state.scene !== before.scene ||
        state.widthPx !== before.widthPx ||
        state.heightPx !== before.heightPx;
      if (hasMoved) write();
    });
  }, [store, viewer, key]);
  if (key === null) return null;

  /** How far along an axis the pointer is; null where that cannot be told. */
  const distanceTo = (event: PointerEvent, middle: Vec3, axis: number): number | null => {
    const { isFlipped } = store.getState();
    const box = root.current?.getBoundingClientRect();
    if (!box) return null;
    const at = [event.clientX - box.left, event.clientY - box.top] as const;
    const [point, direction] = [seen(middle, isFlipped), seen(UNIT_AXES[axis], isFlipped)];
    return distanceAlong(spaceOf(viewer, box), point, direction, at);
  };
  const onPointerDown = (event: PointerEvent<HTMLElement>, axis: number) => {
    const part = selectedPartOf(store.getState());
    if (!part) return;
    event.preventDefault();
    focusByPointer(event.currentTarget);
    event.currentTarget.setPointerCapture(event.pointerId);
    const placement = placementOf(part);
    const middle = placedMiddle(placement);
    const grip = distanceTo(event, middle, axis);
    drag.current = grip === null ? null : { axis, middle, move: placement.move[axis], grip };
  };
  const onPointerMove = (event: PointerEvent<HTMLElement>) => {
    const { current } = drag;
    const part = selectedPartOf(store.getState());
    if (!current || !part) return;
    const distance = distanceTo(event, current.middle, current.axis);
    if (distance === null) return;
    const to = roundedMove(current.move + distance - current.grip, moveStep(part));
    movePart(viewer, part, current.axis, to);
  };
  const endDrag = () => {
    drag.current = null;
  };
  const onKeyDown = (event: KeyboardEvent, axis: number) => {
    const part = selectedPartOf(store.getState());
    const direction = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!part || direction === undefined) return;
    event.preventDefault();
    // Arrows elsewhere turn the scene.
    event.stopPropagation();
    const step = moveStep(part);
    const by = direction * step * (event.shiftKey ? LARGE_STEP : 1);
    movePart(viewer, part, axis, roundedMove(placementOf(part).move[axis] + by, step));
  };
  return (
    <div ref={root} className="over-picture place-gizmo" data-testid="gizmo">
      <svg className="over-picture" aria-hidden="true">
        {AXES.map((name) => (
          <g key={name} className={`axis-${name}`}>
            <line className="gizmo-edge" />
            <line />
          </g>
        ))}
      </svg>
      {AXES.map((name, axis) => (
        <div
          key={name}
          className={`gizmo-handle axis-${name}`}
          role="spinbutton"
          tabIndex={0}
          aria-label={`Move ${title} along ${name}`}
          aria-valuenow={0}
          data-testid={`gizmo-${name}`}
          onPointerDown={(event) => onPointerDown(event, axis)}
          onPointerMove={onPointerMove}
          onPointerUp={endDrag}
          onPointerCancel={endDrag}
          onKeyDown={(event) => onKeyDown(event, axis)}
        >
          <span>{name}</span>
        </div>
      ))}
    </div>
  );
}

function writeGizmo(
  root: HTMLElement | null,
  viewer: Viewer,
  state: Parameters<typeof selectedPartOf>[0] & { readonly isFlipped: boolean },
): void {
  const part = selectedPartOf(state);
  if (!root || !part) return;
  const { isFlipped } = state;
  const placement = placementOf(part);
  const axes = seenAxes(
    spaceOf(viewer, root.getBoundingClientRect()),
    seen(placedMiddle(placement), isFlipped),
    UNIT_AXES.map((axis) => seen(axis, isFlipped)),
    AXIS_LENGTH_PX,
  );
  const lines = root.querySelectorAll('g');
  for (const [i, handle] of root.querySelectorAll<HTMLElement>('.gizmo-handle').entries()) {
    const axis = axes?.[i];
    for (const element of [handle, lines[i]]) element.toggleAttribute('hidden', !axis?.canDrag);
    const move = placement.move[i];
    handle.setAttribute('aria-valuenow', String(move));
    handle.setAttribute('aria-valuetext', `${move} scene units`);
    if (!axis) continue;
    const { from, to } = axis;
    handle.style.translate = `${to[0]}px ${to[1]}px`;
    for (const line of lines[i].children)
      for (const [name, value] of Object.entries({ x1: from[0], y1: from[1], x2: to[0], y2: to[1] }))
        line.setAttribute(name, String(value));
  }
}

/** In the world that the camera sees. */
function seen(point: Vec3, isFlipped: boolean): Vec3 {
  return isFlipped ? flippedPoint(point) : point;
}

function spaceOf({ camera }: Viewer, { width, height }: DOMRect): PictureSpace {
  return { camera: camera.ownCamera ?? camera.orbitCamera, width, height };
}
