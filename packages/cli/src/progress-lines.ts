import type { MeasureProgress } from '@websplatter/core';
import type { Console } from './console.ts';

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
