/** Heights at which a sheet comes to rest, as parts of the window's, the lowest first. */
export const SHEET_PARTS = [0.3, 0.5, 0.9] as const;

const NAMES = ['low', 'half', 'full'] as const;

/** A sheet that is thrown goes on for this long. */
const THROW_S = 0.15;
/** Let go below this part of its lowest height, a sheet closes. */
const CLOSING = 0.6;

/** Resting place of a sheet let go at `part`, growing by `partsPerSecond`; null: it closes. */
export function settledSheet(part: number, partsPerSecond: number): number | null {
  const goal = part + partsPerSecond * THROW_S;
  if (goal < CLOSING * SHEET_PARTS[0]) return null;
  return SHEET_PARTS[sheetStep(goal)];
}

/** The height of a sheet after `key` is pressed on its grip; null if the key does not change it. */
export function steppedSheet(part: number, key: string): number | null {
  const at = sheetStep(part);
  const last = SHEET_PARTS.length - 1;
  const goals: Readonly<Record<string, number>> = {
    ArrowUp: at + 1,
    ArrowRight: at + 1,
    PageUp: at + 1,
    ArrowDown: at - 1,
    ArrowLeft: at - 1,
    PageDown: at - 1,
    Home: 0,
    End: last,
  };
  if (!Object.hasOwn(goals, key)) return null;
  return SHEET_PARTS[Math.min(last, Math.max(0, goals[key]))];
}

/** The next height up, and from the highest the lowest: the action of a tap on the grip. */
export function toggledSheet(part: number): number {
  return SHEET_PARTS[(sheetStep(part) + 1) % SHEET_PARTS.length];
}

/** Which of `SHEET_PARTS` is nearest to `part`. */
function sheetStep(part: number): number {
  const distances = SHEET_PARTS.map((each) => Math.abs(each - part));
  return distances.indexOf(Math.min(...distances));
}

/** The height as a screen reader reads it out. */
export function sheetText(part: number): string {
  return NAMES[sheetStep(part)];
}
