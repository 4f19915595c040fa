/** Longest way of a tap; a pointer that moves further drags. */
export const MAX_WAY_PX = 6;

/** Position and time of a pointer event. */
export type TapEvent = Pick<PointerEvent, 'pointerId' | 'clientX' | 'clientY' | 'timeStamp'>;

/** Distinguishes taps of mouse, pen or finger from drags. */
export class Tap {
  #down: TapEvent | null = null;

  /** @param isPrimary whether it is the only pointer, pressed by its main button. */
  pointerDown(event: TapEvent, isPrimary: boolean): void {
    this.#down = isPrimary ? event : null;
  }

  /** Returns whether releasing the pointer completes a tap. */
  pointerUp(event: TapEvent): boolean {
    const down = this.#down;
    this.#down = null;
    return down?.pointerId === event.pointerId && wayPx(down, event) <= MAX_WAY_PX;
  }
}

export function wayPx(a: TapEvent, b: TapEvent): number {
  return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
}
