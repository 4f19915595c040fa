import {
  cropSplats,
  transformSplats,
  uprightRotation,
  WRITABLE_FORMATS,
  writeSplats,
} from '@websplatter/core/write';
import { oppositeAxis } from '../camera/up-axis.ts';
import { readAgain } from '../rereading/read-again.ts';
import type { SavingState } from '../state/saving.ts';
import type { SaveRequest } from './save-messages.ts';

export type OnSaving = (progress: Pick<SavingState, 'phase' | 'part'>) => void;

/** Reads a scene again and writes it as a file, turned so that other viewers show it the way up that this one does. */
export async function writeScene(
  { source, formatName, up, crop }: Omit<SaveRequest, 'kind'>,
  onProgress: OnSaving,
): Promise<Uint8Array<ArrayBuffer>> {
  onProgress({ phase: 'read', part: undefined });
  const read = await readAgain(source, (part) => onProgress({ phase: 'read', part }));
  onProgress({ phase: 'write', part: 0 });
  const set = crop ? cropSplats(read, crop) : read;
  const hasYUp = WRITABLE_FORMATS.some((format) => format.name === formatName && format.hasYUp);
  // In formats whose y axis points down, what is up goes there.
  const toY = hasYUp ? up : oppositeAxis(up);
  const turned = toY === 'y' ? set : transformSplats(set, { rotation: uprightRotation(toY) });
  return writeSplats(turned, formatName, { onProgress: (part) => onProgress({ phase: 'write', part }) });
}
