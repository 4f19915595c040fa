import type { Ramp } from './ramp.ts';

/** A number beside a scale. */
export interface Tick {
  /** Place on the scale, 0…1. */
  readonly part: number;
  readonly text: string;
}

/** Meaning of the colours of a mode. */
export interface ColorScale extends Ramp {
  /** The quantity and its unit. */
  readonly title: string;
  /** From the low end to the high one. */
  readonly ticks: readonly Tick[];
}

/** Five numbers at equal distances; `write` tells that at a part of the scale. */
export function evenTicks(write: (part: number) => string): readonly Tick[] {
  return [0, 0.25, 0.5, 0.75, 1].map((part) => ({ part, text: write(part) }));
}
