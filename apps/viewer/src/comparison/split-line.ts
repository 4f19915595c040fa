/** Parts of the width by which a key moves the line. */
const STEP = 0.01;
const LARGE_STEP = 0.1;

/** Where the line of a split picture goes from `part` (0…1 of the width) by a key; null where the key means nothing to it. */
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

/** What a screen reader says of the line. */
export function splitText(part: number, left: string, right: string): string {
  const percent = Math.round(100 * part);
  return `${percent} % ${left}, ${100 - percent} % ${right}`;
}
