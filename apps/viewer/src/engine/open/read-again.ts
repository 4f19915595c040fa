import { type Harmonics, readSplats, type SplatSet } from '@websplatter/core';
import type { StoredSource } from './stored-source.ts';

/**
 * Reads a cloud's splats as they were shown, with harmonics in float32.
 *
 * @param onPart called with the fraction read, 0…1; undefined if it is unknown.
 */
export async function readAgain(
  source: StoredSource,
  onPart: (part: number | undefined) => void,
): Promise<SplatSet<Harmonics>> {
  if (source.kind === 'set') return source.set;
  if (source.kind !== 'bytes' && source.frame !== undefined) {
    const { openFrameFile } = await import('../play/open-frame-file.ts');
    const file = await openFrameFile(source);
    return readSplats(file.frames[source.frame], { shPrecision: 'f32' }).finally(() => file.end());
  }
  const isFile = source.kind === 'file';
  return readSplats(bytesOf(source), {
    name: isFile ? source.name : undefined,
    maxSplats: isFile ? Number.POSITIVE_INFINITY : undefined,
    shPrecision: 'f32',
    onProgress: ({ loadedBytes, totalBytes }) => onPart(totalBytes ? loadedBytes / totalBytes : undefined),
  });
}

function bytesOf(source: Exclude<StoredSource, { kind: 'set' }>) {
  switch (source.kind) {
    case 'file':
      return source.source;
    case 'url':
      return new URL(source.href);
    case 'bytes':
      return source.bytes;
  }
}
