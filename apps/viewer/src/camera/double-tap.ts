/** Two taps within this time are one double tap. */
const MAX_PAUSE_MS = 400;
/** Fingers do not meet the same place twice. */
const MAX_APART_PX = 24;
/** A pointer that goes further drags. */
const MAX_WAY_PX = 6;

/** A pointer's place and time, as its events have them. */
export type TapEvent = Pick<PointerEvent, 'pointerId' | 'clientX' | 'clientY' | 'timeStamp'>;

/**
 * Tells double taps of a mouse, a pen or a finger. Browsers' own event for that is missing on some touch screens, above all
 * where a page keeps them from zooming.
 */
export class DoubleTap {
  #down: TapEvent | null = null;
  #lastTap: TapEvent | null = null;

  /** @param isPrimary whether it is the only pointer, and by its main button. */
  pointerDown(event: TapEvent, isPrimary: boolean): void {
    this.#down = isPrimary ? event : null;
    if (!isPrimary) this.#lastTap = null;
  }

  /** Returns whether the pointer that goes up ends a double tap. */
  pointerUp(event: TapEvent): boolean {
    const down = this.#down;
    const last = this.#lastTap;
    this.#down = null;
    this.#lastTap = null;
    if (down?.pointerId !== event.pointerId || wayPx(down, event) > MAX_WAY_PX) return false;
    const isSecond =
      last !== null && event.timeStamp - last.timeStamp < MAX_PAUSE_MS && wayPx(last, event) < MAX_APART_PX;
    // A third tap begins anew.
    if (!isSecond) this.#lastTap = event;
    return isSecond;
  }
}

function wayPx(a: TapEvent, b: TapEvent): number {
  return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
}
