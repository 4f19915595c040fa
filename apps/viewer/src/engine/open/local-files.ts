import type { SceneFiles } from '@websplatter/core';

export interface LocalFile {
  /** Its name, or its path from the folder of a scene in several files. */
  readonly path: string;
  readonly bytes: Blob;
}

/** The files of a scene that was opened from this device. */
export function localFiles(source: File | SceneFiles): readonly LocalFile[] {
  if (source instanceof File) return [{ path: source.name, bytes: source }];
  return source.files.map((bytes, i) => ({ path: source.paths?.[i] ?? ownPath(bytes, i), bytes }));
}

function ownPath(file: Partial<File>, index: number): string {
  return file.webkitRelativePath || file.name || String(index);
}
