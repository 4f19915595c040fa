import type { StageTimings } from '@websplatter/core';

/** Reasons why measured times are not exact, in words. */
export function timingCautions(isSoftware: boolean, source: StageTimings['source']): readonly string[] {
  const cautions = [];
  if (isSoftware) cautions.push('Measured without a GPU: times are those of the CPU.');
  if (source === 'wall-clock')
    cautions.push('Times are the wall clock’s, since this GPU does not time its own work.');
  return cautions;
}
