import { droppedTotal } from '../engine/open/dropped-words.ts';
import type { ShownPart } from '../engine/open/shown-scene.ts';
import { framesOf } from '../engine/play/scene-time.ts';
import { FieldError } from '../state/json-fields.ts';
import type { RowMasks } from '../state/selecting.ts';

/** Rows of a cloud's file. */
export interface CloudRows {
  readonly most: number;
  /** Whether there are exactly so many, not fewer. */
  readonly isExact: boolean;
}

/**
 * The rows of a cloud by a key as `KeptWork.removed` has it. Null for a cloud that its file does not
 * have; undefined if the file is not in the scene.
 */
export type RowsOf = (key: string) => CloudRows | null | undefined;

/** Rows of a streamed scene's files, by splats: coarser levels have rows of their own. */
const MOST_STREAMED = 8;

/** @param parts files of the scene in the order in which they were kept; undefined for missing ones. */
export function rowsIn(parts: readonly (Pick<ShownPart, 'loaded' | 'source'> | undefined)[]): RowsOf {
  return (key) => {
    const [place, index] = key.split('/').map(Number);
    const part = parts[place];
    if (!part) return undefined;
    const { clouds, sampleFailure } = part.loaded;
    const frames = clouds.map(({ cloud }) => framesOf(cloud)).find(Boolean);
    // Frames have rows of their own, and a byte may tell of eight.
    if (frames) return index < frames.count ? { most: 8 * frames.bytes, isExact: false } : null;
    const cloud = clouds[index]?.cloud;
    if (!cloud) return null;
    const rows = cloud.count + droppedTotal(cloud.dropped);
    const { source } = part;
    // Only some rows of a large PLY are there, which has bytes for each.
    if (sampleFailure && source.kind === 'file' && source.source instanceof Blob)
      return { most: source.source.size, isExact: false };
    return cloud.stream ? { most: MOST_STREAMED * rows, isExact: false } : { most: rows, isExact: true };
  };
}

/** Bytes of a bit for each row, in words of 32. */
export function maskBytes(rows: number): number {
  return 4 * Math.ceil(rows / 32);
}

/** @throws FieldError if a mask is of a cloud that the scene does not have, or of more rows than that has. */
export function checkMasks(masks: RowMasks, rowsOf: RowsOf): void {
  for (const [key, words] of masks) {
    const rows = rowsOf(key);
    if (rows !== undefined) checkMask(key, words, rows);
  }
}

/** @throws FieldError as `checkMasks` does. */
export function checkMask(key: string, words: Uint32Array, rows: CloudRows | null): void {
  if (!rows) throw new FieldError('removed', key, 'a cloud that its file has');
  const word = words.findLastIndex((each) => each !== 0);
  const last = word < 0 ? -1 : 32 * word + 31 - Math.clz32(words[word]);
  if (last >= rows.most) throw new FieldError(`The last row of removed ${key}`, last, `below ${rows.most}`);
}
