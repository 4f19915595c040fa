import { type Harmonics, readSplats, type SceneFiles, type SplatSet } from '@websplatter/core';
import {
  mergeSplats,
  transformSplats,
  uprightRotation,
  WRITABLE_FORMATS,
  writeSplats,
} from '@websplatter/core/write';
import { oppositeAxis, type UpAxis } from '../camera/up-axis.ts';
import { transformOf } from '../placing/placement.ts';
import { makeBuiltin } from '../scene/make-builtin.ts';
import type { SavingState } from '../state/saving.ts';
import type { Placement } from '../state/scene-part.ts';

/** What a file of a scene is read from again. */
export type SavedSource =
  | { readonly kind: 'builtin'; readonly name: string }
  | { readonly kind: 'file'; readonly name: string; readonly source: File | SceneFiles }
  | { readonly kind: 'url'; readonly href: string };

/** A file of a scene, and how it is drawn. */
export interface SavedPart {
  readonly source: SavedSource;
  /** Null where it stands as it was saved. */
  readonly placement: Placement | null;
  /** Above 0, at most 1. */
  readonly opacity: number;
}

export interface SaveRequest {
  /** One or more; their splats are written one after another. */
  readonly parts: readonly SavedPart[];
  /** Of `WRITABLE_FORMATS`. */
  readonly formatName: string;
  /** The axis of the scene's own that is shown upwards. */
  readonly up: UpAxis;
}

export type OnSaving = (progress: Pick<SavingState, 'phase' | 'part'>) => void;

/** Reads a scene again and writes it as a file, turned so that other viewers show it the way up that this one does. */
export async function writeScene(
  { parts, formatName, up }: SaveRequest,
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
  const set = mergeSplats(sets);
  onProgress({ phase: 'write', part: 0 });
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
