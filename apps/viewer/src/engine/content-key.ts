import type { SceneSource } from './scene-source.ts';

/**
 * Names what a source holds, for things that are kept with a scene. Trainings write many files of
 * the same name, so a file is named by its size and its first megabyte. A file on a server is named
 * by its address, which needs no second download.
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
