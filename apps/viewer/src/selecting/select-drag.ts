import type { DragRegion, SelectMode } from '../state/selecting.ts';
import type { ViewerStore } from '../state/store.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';

/** Receives the region of a drag in an image of this size, CSS px. */
export type OnSelected = (dragged: DragRegion, width: number, height: number, mode: SelectMode) => void;

/** A shorter way is a click, which has no rectangle. */
const LEAST_SIDE_PX = 3;

interface Drag {
  readonly down: PointerEvent;
  readonly canvas: HTMLElement;
}

/**
 * While a tool is chosen, drags over the picture select instead of turning the camera; with a
 * second finger both go on to move it. Shift adds, Alt subtracts.
 */
export function listenToSelectDrags(store: ViewerStore, onSelected: OnSelected, signal: AbortSignal): void {
  let drag: Drag | null = null;
  let isHandedOver = false;
  const listen = (type: string, handler: (event: PointerEvent) => void) =>
    // Before the canvas hears of it.
    addEventListener(type, handler as (event: Event) => void, { signal, capture: true });
  const show = (dragged: DragRegion | null) =>
    store.setState(({ inspecting }) => ({
      inspecting: { ...inspecting, selecting: { ...inspecting.selecting, dragged } },
    }));
  const end = () => {
    drag = null;
    show(null);
  };
  const selecting = () => store.getState().inspecting.selecting;

  listen('pointerdown', (event) => {
    if (isHandedOver) return;
    if (drag) {
      const { down, canvas } = drag;
      end();
      isHandedOver = true;
      canvas.dispatchEvent(new PointerEvent('pointerdown', down));
      isHandedOver = false;
      return;
    }
    const { target } = event;
    if (!begins(event, store) || !(target instanceof HTMLElement)) return;
    event.stopPropagation();
    event.preventDefault();
    focusByPointer(target);
    target.setPointerCapture(event.pointerId);
    drag = { down: event, canvas: target };
    const { tool, brushRadius: radius } = selecting();
    const [x, y] = placeOf(event, target);
    show(
      tool === 'brush'
        ? { kind: 'brush', points: [x, y], radius }
        : { kind: 'rectangle', from: [x, y], to: [x, y] },
    );
  });
  listen('pointermove', (event) => {
    const { dragged } = selecting();
    if (drag?.down.pointerId !== event.pointerId || !dragged) return;
    const [x, y] = placeOf(event, drag.canvas);
    show(
      dragged.kind === 'brush'
        ? { ...dragged, points: [...dragged.points, x, y] }
        : { ...dragged, to: [x, y] },
    );
  });
  listen('pointerup', (event) => {
    const { dragged, mode } = selecting();
    if (drag?.down.pointerId !== event.pointerId) return;
    const { clientWidth, clientHeight } = drag.canvas;
    end();
    if (!dragged || isEmpty(dragged) || store.getState().dock !== 'inspect') return;
    onSelected(dragged, clientWidth, clientHeight, event.shiftKey ? 'add' : event.altKey ? 'subtract' : mode);
  });
  for (const type of ['pointercancel', 'lostpointercapture'])
    listen(type, (event) => {
      if (drag?.down.pointerId === event.pointerId) end();
    });
}

function begins({ isPrimary, button, target }: PointerEvent, store: ViewerStore): boolean {
  const { dock, flightSpeed, inspecting } = store.getState();
  const isChosen = dock === 'inspect' && inspecting.tab === 'select' && inspecting.selecting.tool !== null;
  const isOverPicture = target instanceof HTMLElement && target.matches('.viewport');
  return isChosen && flightSpeed === null && isPrimary && button === 0 && isOverPicture;
}

function placeOf({ clientX, clientY }: PointerEvent, canvas: HTMLElement): [number, number] {
  const { left, top } = canvas.getBoundingClientRect();
  return [clientX - left, clientY - top];
}

function isEmpty(dragged: DragRegion): boolean {
  if (dragged.kind === 'brush') return false;
  const { from, to } = dragged;
  return Math.min(Math.abs(from[0] - to[0]), Math.abs(from[1] - to[1])) < LEAST_SIDE_PX;
}
