import type { SceneSource } from './scene-source.ts';

/**
 * Returns a key for the contents of a source, under which annotations, views and the known length that
 * gives the scene its scale are stored. A local file's key is its size and a hash of its first megabyte, because trainings
 * write many files of the same name. The key of a file on a server is its address:
 * to hash it, it would be fetched twice.
 */
export async function contentKeyOf(source: SceneSource): Promise<string> {
  if (source.kind === 'builtin') return `scene:${source.scene.name}`;
  if (source.kind === 'hard-case') return `case:${source.name}`;
  if (source.kind === 'url') return source.url.href.replace(/#.*/, '');
  try {
    const { fileKey } = await import('./file-key.ts');
    return await fileKey(source.source);
  } catch {
    // The file has gone; the load says so.
    return `name:${source.name}`;
  }
}
