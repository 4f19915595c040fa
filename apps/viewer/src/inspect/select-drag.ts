import { pictureSpace, placeOf } from '../engine/show/over-picture.ts';
import type { SelectMode } from '../state/selecting.ts';
import type { ViewerStore } from '../state/store.ts';
import { keyScope } from '../ui/key-scope.ts';
import { focusByPointer } from '../ui/pointer-focus.ts';
import type { InspectTools } from './inspect-tools.ts';
import { withoutCorner, withPointerAt } from './polygon.ts';
import { beginGesture, closePolygon, drawnPolygon, type SelectGesture } from './select-gestures.ts';
import type { SplatSelecting } from './splat-selecting.ts';

/** Distance from the first corner at which a click closes a polygon, by mouse and by finger. */
const REACH_PX = { fine: 10, touch: 22 } as const;

interface Drag {
  readonly down: PointerEvent;
  readonly canvas: HTMLElement;
  readonly gesture: SelectGesture;
}

/**
 * While a tool is active, drags over the picture select instead of turning the camera; two fingers
 * still move the camera. Shift adds, Alt subtracts. Keys close a polygon, remove its last corner or
 * cancel it.
 */
export function listenToSelectDrags(
  { store, viewer }: Pick<InspectTools, 'store' | 'viewer'>,
  selecting: SplatSelecting,
  signal: AbortSignal,
): void {
  let drag: Drag | null = null;
  let isHandedOver = false;
  const listen = <E extends Event>(type: string, handler: (event: E) => void) =>
    // Captured before the canvas and the window's key handlers.
    addEventListener(type, handler as (event: Event) => void, { signal, capture: true });
  const cancel = () => {
    drag?.gesture.cancel();
    drag = null;
  };

  listen<PointerEvent>('pointerdown', (event) => {
    if (isHandedOver) return;
    if (drag) {
      const { down, canvas } = drag;
      cancel();
      isHandedOver = true;
      canvas.dispatchEvent(new PointerEvent('pointerdown', down));
      isHandedOver = false;
      return;
    }
    const { target, isPrimary, button, pointerType } = event;
    const { tool } = selecting.now;
    const space = pictureSpace(viewer, document.documentElement);
    if (!tool || !space || !isSelecting(store) || !isPrimary || button !== 0 || !isPicture(target)) return;
    const reachPx = pointerType === 'touch' ? REACH_PX.touch : REACH_PX.fine;
    const gesture = beginGesture(tool, selecting, placeOf(event), { space, reachPx });
    if (!gesture) return;
    event.stopPropagation();
    event.preventDefault();
    focusByPointer(target);
    target.setPointerCapture(event.pointerId);
    drag = { down: event, canvas: target, gesture };
  });
  listen<PointerEvent>('pointermove', (event) => {
    const { target } = event;
    const polygon = drawnPolygon(selecting);
    if (drag?.down.pointerId === event.pointerId) drag.gesture.move(placeOf(event));
    else if (!drag && polygon && event.buttons === 0 && isSelecting(store) && isPicture(target))
      selecting.choose({ dragged: withPointerAt(polygon, placeOf(event)) });
  });
  listen<PointerEvent>('pointerup', (event) => {
    if (drag?.down.pointerId !== event.pointerId) return;
    const { gesture } = drag;
    drag = null;
    if (store.getState().dock === 'inspect') gesture.end(modeOf(event, selecting));
    else gesture.cancel();
  });
  for (const type of ['pointercancel', 'lostpointercapture'])
    listen<PointerEvent>(type, (event) => {
      if (drag?.down.pointerId === event.pointerId) cancel();
    });
  listen<KeyboardEvent>('keydown', (event) => {
    const { key, target } = event;
    const polygon = drawnPolygon(selecting);
    const space = pictureSpace(viewer, document.documentElement);
    const isCommand = event.ctrlKey || event.metaKey;
    if (!polygon || !space || !isSelecting(store) || isCommand || keyScope(target) === 'text') return;
    if (key === 'Escape') {
      cancel();
      selecting.choose({ dragged: null });
    } else if (key === 'Backspace') selecting.choose({ dragged: withoutCorner(polygon) });
    else if (key === 'Enter' && !(target instanceof HTMLButtonElement))
      closePolygon(selecting, space, modeOf(event, selecting));
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
}

/** How a new selection combines with the current one, by the held keys. */
export function modeOf(
  { shiftKey, altKey }: Pick<MouseEvent, 'shiftKey' | 'altKey'>,
  { now }: SplatSelecting,
): SelectMode {
  return shiftKey ? 'add' : altKey ? 'subtract' : now.mode;
}

/** Whether a pointer over the picture may select. */
function isSelecting(store: ViewerStore): boolean {
  const { dock, travelling, inspecting, isHelpVisible } = store.getState();
  return dock === 'inspect' && inspecting.tab === 'select' && travelling === null && !isHelpVisible;
}

function isPicture(target: EventTarget | null): target is HTMLElement {
  return target instanceof HTMLElement && target.matches('.viewport');
}
