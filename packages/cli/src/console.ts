import type { MeasureProgress } from '@websplatter/core';

/** Output of a command, which tests can capture. */
export interface Console {
  /** Results. */
  out(text: string): void;
  /** One-line notes and errors. */
  err(text: string): void;
}

/** Writes a line per ten percent of a measurement: standard error may be a file. */
export function tenthsOf(console: Console): (progress: MeasureProgress) => void {
  let shownTenth = -1;
  return ({ done, total, label }) => {
    const percent = Math.floor((100 * done) / total);
    const tenth = Math.floor(percent / 10);
    if (tenth > shownTenth) console.err(`${percent} %: ${label}\n`);
    shownTenth = Math.max(shownTenth, tenth);
  };
}
