import type { Ramp } from './ramp.ts';

/** A number beside a colour scale. */
export interface Tick {
  /** Position on the scale, 0…1. */
  readonly part: number;
  readonly text: string;
}

/** The colours of a view mode, and their meaning. */
export interface ColorScale extends Ramp {
  /** The quantity and its unit. */
  readonly title: string;
  /** From the low end to the high end. */
  readonly ticks: readonly Tick[];
}

/** Five numbers at equal distances; `write` formats the number at a position 0…1. */
export function evenTicks(write: (part: number) => string): readonly Tick[] {
  return [0, 0.25, 0.5, 0.75, 1].map((part) => ({ part, text: write(part) }));
}
