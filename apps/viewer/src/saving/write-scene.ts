import { type Harmonics, readSplats, type SceneFiles, type SplatSet } from '@websplatter/core';
import { transformSplats, uprightRotation, WRITABLE_FORMATS, writeSplats } from '@websplatter/core/write';
import { oppositeAxis, type UpAxis } from '../camera/up-axis.ts';
import { makeBuiltin } from '../scene/make-builtin.ts';
import type { SavingState } from '../state/saving.ts';

/** What a scene is read from again. */
export type SavedSource =
  | { readonly kind: 'builtin'; readonly name: string }
  | { readonly kind: 'file'; readonly name: string; readonly source: File | SceneFiles }
  | { readonly kind: 'url'; readonly href: string };

export interface SaveRequest {
  readonly source: SavedSource;
  /** Of `WRITABLE_FORMATS`. */
  readonly formatName: string;
  /** The axis of the scene's own that is shown upwards. */
  readonly up: UpAxis;
}

export type OnSaving = (progress: Pick<SavingState, 'phase' | 'part'>) => void;

/** Reads a scene again and writes it as a file, turned so that other viewers show it the way up that this one does. */
export async function writeScene(
  { source, formatName, up }: SaveRequest,
  onProgress: OnSaving,
): Promise<Uint8Array<ArrayBuffer>> {
  onProgress({ phase: 'read', part: undefined });
  const set = await readAgain(source, (part) => onProgress({ phase: 'read', part }));
  onProgress({ phase: 'write', part: 0 });
  const hasYUp = WRITABLE_FORMATS.some((format) => format.name === formatName && format.hasYUp);
  // In formats whose y axis points down, what is up goes there.
  const toY = hasYUp ? up : oppositeAxis(up);
  const turned = toY === 'y' ? set : transformSplats(set, { rotation: uprightRotation(toY) });
  return writeSplats(turned, formatName, { onProgress: (part) => onProgress({ phase: 'write', part }) });
}

async function readAgain(
  source: SavedSource,
  onPart: (part: number | undefined) => void,
): Promise<SplatSet<Harmonics>> {
  if (source.kind === 'builtin') return makeBuiltin(source.name);
  const isFile = source.kind === 'file';
  return readSplats(isFile ? source.source : new URL(source.href), {
    name: isFile ? source.name : undefined,
    // As they were shown.
    maxSplats: isFile ? Number.POSITIVE_INFINITY : undefined,
    shPrecision: 'f32',
    onProgress: ({ loadedBytes, totalBytes }) => onPart(totalBytes ? loadedBytes / totalBytes : undefined),
  });
}
