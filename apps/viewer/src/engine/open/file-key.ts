import type { SceneFiles } from '@websplatter/core';

/** Tell a file from others of the same size. */
const HASHED_BYTES = 2 ** 20;

/** Key of a local file: its size, and a hash of its first megabyte. Rejects if it cannot be read. */
export async function fileKey(source: File | SceneFiles): Promise<string> {
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
