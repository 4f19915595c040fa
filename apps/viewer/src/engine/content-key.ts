import type { SceneFiles } from '@websplatter/core';
import type { SceneSource } from './scene-source.ts';

/** Bytes of a file that tell it from others of the same size. */
const HASHED_BYTES = 2 ** 20;

/**
 * Names what a source holds, for things that are kept with a scene. Trainings write many files of
 * the same name, so a file is named by its size and its first megabyte. A file on a server is named
 * by its address, which needs no second download.
 */
export async function contentKeyOf(source: SceneSource): Promise<string> {
  switch (source.kind) {
    case 'builtin':
      return `scene:${source.scene.name}`;
    case 'hard-case':
      return `case:${source.name}`;
    case 'url': {
      const url = new URL(source.url);
      url.hash = '';
      return url.href;
    }
    case 'file':
      return fileKey(source.source).catch(() => {
        // The file has gone; the load says so.
        return `name:${source.name}`;
      });
  }
}

async function fileKey(source: File | SceneFiles): Promise<string> {
  if (source instanceof Blob) return `file:${source.size}:${await hashOf(source)}`;
  const { files, paths = [] } = source;
  const listed = files.map((file, i) => ({
    file,
    path: paths[i] ?? ('name' in file ? String(file.name) : ''),
  }));
  listed.sort((a, b) => (a.path < b.path ? -1 : 1));
  const contents = listed.map(({ file, path }) => `${path} ${file.size}\n`);
  const first = listed.find(({ path }) => path.endsWith('.json')) ?? listed[0];
  return `files:${await hashOf(new Blob([...contents, first.file.slice(0, HASHED_BYTES)]))}`;
}

async function hashOf(blob: Blob): Promise<string> {
  const bytes = await blob.slice(0, HASHED_BYTES).arrayBuffer();
  const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes));
  return Array.from(digest, (byte) => byte.toString(16).padStart(2, '0')).join('');
}
