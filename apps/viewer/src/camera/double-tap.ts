import { Tap, type TapEvent, wayPx } from './tap.ts';

/** Two taps within this time are one double tap. */
const MAX_PAUSE_MS = 400;
/** Fingers do not meet the same place twice. */
const MAX_APART_PX = 24;

/**
 * Tells double taps of a mouse, a pen or a finger. Browsers' own event for that is missing on some
 * touch screens, above all where a page keeps them from zooming.
 */
export class DoubleTap {
  readonly #tap = new Tap();
  #lastTap: TapEvent | null = null;

  /** @param isPrimary whether it is the only pointer, and by its main button. */
  pointerDown(event: TapEvent, isPrimary: boolean): void {
    this.#tap.pointerDown(event, isPrimary);
    if (!isPrimary) this.#lastTap = null;
  }

  /** Returns whether the pointer that goes up ends a double tap. */
  pointerUp(event: TapEvent): boolean {
    const last = this.#lastTap;
    this.#lastTap = null;
    if (!this.#tap.pointerUp(event)) return false;
    const isSecond =
      last !== null && event.timeStamp - last.timeStamp < MAX_PAUSE_MS && wayPx(last, event) < MAX_APART_PX;
    // A third tap begins anew.
    if (!isSecond) this.#lastTap = event;
    return isSecond;
  }
}
