/** A pointer that goes further drags. */
export const MAX_WAY_PX = 6;

/** A pointer's place and time, as its events have them. */
export type TapEvent = Pick<PointerEvent, 'pointerId' | 'clientX' | 'clientY' | 'timeStamp'>;

/** Tells taps of a mouse, a pen or a finger from drags. */
export class Tap {
  #down: TapEvent | null = null;

  /** @param isPrimary whether it is the only pointer, and by its main button. */
  pointerDown(event: TapEvent, isPrimary: boolean): void {
    this.#down = isPrimary ? event : null;
  }

  /** Returns whether the pointer that goes up ends a tap. */
  pointerUp(event: TapEvent): boolean {
    const down = this.#down;
    this.#down = null;
    return down?.pointerId === event.pointerId && wayPx(down, event) <= MAX_WAY_PX;
  }
}

export function wayPx(a: TapEvent, b: TapEvent): number {
  return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
}
