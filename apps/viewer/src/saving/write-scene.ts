import type { Harmonics, SplatSet } from '@websplatter/core';
import {
  cropSplats,
  mergeSplats,
  transformSplats,
  uprightRotation,
  WRITABLE_FORMATS,
  writeSplats,
} from '@websplatter/core/write';
import { oppositeAxis } from '../camera/up-axis.ts';
import { transformOf } from '../placing/placement.ts';
import { readAgain } from '../rereading/read-again.ts';
import type { SavingState } from '../state/saving.ts';
import type { SaveRequest } from './save-messages.ts';

export type OnSaving = (progress: Pick<SavingState, 'phase' | 'part'>) => void;

/** Reads a scene again and writes it as a file, turned so that other viewers show it the way up that this one does. */
export async function writeScene(
  { parts, formatName, up, crop }: Omit<SaveRequest, 'kind'>,
  onProgress: OnSaving,
): Promise<Uint8Array<ArrayBuffer>> {
  onProgress({ phase: 'read', part: undefined });
  const sets: SplatSet<Harmonics>[] = [];
  for (const [i, { source, placement, opacity }] of parts.entries()) {
    const set = await readAgain(source, (part) => {
      onProgress({ phase: 'read', part: part === undefined ? undefined : (i + part) / parts.length });
    });
    sets.push(fadedSplats(placement ? transformSplats(set, transformOf(placement)) : set, opacity));
  }
  const merged = mergeSplats(sets);
  onProgress({ phase: 'write', part: 0 });
  const set = crop ? cropSplats(merged, crop) : merged;
  const hasYUp = WRITABLE_FORMATS.some((format) => format.name === formatName && format.hasYUp);
  // In formats whose y axis points down, what is up goes there.
  const toY = hasYUp ? up : oppositeAxis(up);
  const turned = toY === 'y' ? set : transformSplats(set, { rotation: uprightRotation(toY) });
  return writeSplats(turned, formatName, { onProgress: (part) => onProgress({ phase: 'write', part }) });
}

/** With every opacity multiplied. */
function fadedSplats(set: SplatSet<Harmonics>, by: number): SplatSet<Harmonics> {
  if (by === 1) return set;
  // The logit of by / (1 + e^-logit).
  const faded = (logit: number) => Math.log(by) - Math.log(1 - by + Math.exp(-logit));
  return { ...set, opacityLogits: set.opacityLogits.map(faded) };
}
