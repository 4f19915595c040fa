import { type Harmonics, InvalidArgumentError, type SplatSet } from '@websplatter/core';
import {
  cropSplats,
  filterSplats,
  mergeSplats,
  transformSplats,
  uprightRotation,
  WRITABLE_FORMATS,
  writeSplats,
} from '@websplatter/core/write';
import { transformOf } from '../engine/placement.ts';
import { readAgain } from '../engine/read-again.ts';
import type { SavingState } from '../state/saving.ts';
import { oppositeAxis } from '../state/up-axis.ts';
import type { SavedRows, SaveRequest } from './save-messages.ts';

export type OnSaving = (progress: Pick<SavingState, 'phase' | 'part'>) => void;

/**
 * Reads a scene again and writes it as a file that other viewers show the same way up.
 *
 * @param onNote called with a sentence for each kind of data that the format cannot store.
 */
export async function writeScene(
  { parts, formatName, up, crop }: Omit<SaveRequest, 'kind'>,
  onProgress: OnSaving,
  onNote: (note: string) => void = () => {},
): Promise<Uint8Array<ArrayBuffer>> {
  onProgress({ phase: 'read', part: undefined });
  const sets: SplatSet<Harmonics>[] = [];
  for (const [i, { source, placement, opacity, rows }] of parts.entries()) {
    const whole = await readAgain(source, (part) => {
      onProgress({ phase: 'read', part: part === undefined ? undefined : (i + part) / parts.length });
    });
    const set = rows ? savedSplats(whole, rows) : whole;
    if (set.count > 0)
      sets.push(fadedSplats(placement ? transformSplats(set, transformOf(placement)) : set, opacity));
  }
  if (sets.length === 0) throw new InvalidArgumentError('scene', 'It has no splats left to save.');
  const merged = mergeSplats(sets);
  onProgress({ phase: 'write', part: 0 });
  const set = crop ? cropSplats(merged, crop) : merged;
  const hasYUp = WRITABLE_FORMATS.some((format) => format.name === formatName && format.hasYUp);
  // In formats whose y axis points down, up is −y.
  const toY = hasYUp ? up : oppositeAxis(up);
  const turned = toY === 'y' ? set : transformSplats(set, { rotation: uprightRotation(toY) });
  return writeSplats(turned, formatName, {
    onProgress: (part) => onProgress({ phase: 'write', part }),
    onNote,
  });
}

function savedSplats(set: SplatSet<Harmonics>, { words, areSaved }: SavedRows): SplatSet<Harmonics> {
  const { fileIndices } = set;
  // Rows beyond the last word read undefined, whose bits are 0.
  return filterSplats(
    set,
    (i) => (((words[fileIndices[i] >>> 5] >>> (fileIndices[i] & 31)) & 1) === 1) === areSaved,
  );
}

/** Multiplies every opacity by `by`. */
function fadedSplats(set: SplatSet<Harmonics>, by: number): SplatSet<Harmonics> {
  if (by === 1) return set;
  // The logit of by / (1 + e^−logit).
  const faded = (logit: number) => Math.log(by) - Math.log(1 - by + Math.exp(-logit));
  return { ...set, opacityLogits: set.opacityLogits.map(faded) };
}
