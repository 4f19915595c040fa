/** Parts of the width by which a key moves the line. */
const STEP = 0.01;
const LARGE_STEP = 0.1;

/** The line's position after a key press at `part` (0…1 of the width); null for other keys. */
export function movedSplit(part: number, key: string, isShift: boolean): number | null {
  const step = isShift ? LARGE_STEP : STEP;
  const goals: Readonly<Record<string, number>> = {
    ArrowLeft: part - step,
    ArrowDown: part - step,
    ArrowRight: part + step,
    ArrowUp: part + step,
    PageDown: part - LARGE_STEP,
    PageUp: part + LARGE_STEP,
    Home: 0,
    End: 1,
  };
  if (!Object.hasOwn(goals, key)) return null;
  // Rounded, so that steps there and back meet.
  return Math.min(1, Math.max(0, Math.round(1000 * goals[key]) / 1000));
}

/** The position of the line as a screen reader reads it out. */
export function splitText(part: number, left: string, right: string): string {
  const percent = Math.round(100 * part);
  return `${percent} % ${left}, ${100 - percent} % ${right}`;
}
