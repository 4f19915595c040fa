/** Positions of a slider run from 0 to this. */
export const SLIDER_STEPS = 200;
/** Ranges with a larger ratio of their ends are geometric: steps multiply by one factor. */
const LARGEST_LINEAR_RATIO = 20;

interface ValueRange {
  readonly min: number;
  readonly max: number;
}

/** The value at a slider's `position`, 0…SLIDER_STEPS, to three digits; both ends are exact. */
export function valueAt(position: number, { min, max }: ValueRange): number {
  if (position <= 0) return min;
  if (position >= SLIDER_STEPS) return max;
  const part = position / SLIDER_STEPS;
  const value = isByRatio({ min, max }) ? min * (max / min) ** part : min + (max - min) * part;
  return Math.min(max, Math.max(min, Number(value.toPrecision(3))));
}

/** The slider's position for `value`. */
export function positionOf(value: number, { min, max }: ValueRange): number {
  const part = isByRatio({ min, max })
    ? Math.log(value / min) / Math.log(max / min)
    : (value - min) / (max - min);
  return Math.round(part * SLIDER_STEPS);
}

function isByRatio({ min, max }: ValueRange): boolean {
  return min > 0 && max / min > LARGEST_LINEAR_RATIO;
}
