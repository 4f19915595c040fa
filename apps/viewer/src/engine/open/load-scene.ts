import type { SceneFiles, SplatCloud, SplatEngine } from '@websplatter/core';
import { type SceneSource, titleOf } from './scene-source.ts';
import type { LoadedScene, LoadSceneOptions } from './shown-scene.ts';

/** Reads or makes `source` and uploads it. A failed or cancelled load leaves nothing on the GPU. */
export async function loadScene(
  engine: SplatEngine,
  source: SceneSource,
  options: LoadSceneOptions,
): Promise<LoadedScene> {
  const { signal, onProgress } = options;
  if (source.kind === 'hard-case') {
    const { loadHardCase } = await import('./load-hard-case.ts');
    return loadHardCase(engine, source.name, options);
  }
  const builtin = source.kind === 'builtin' ? source.scene : null;
  const sceneOf = (cloud: SplatCloud) => ({
    clouds: [{ cloud }],
    firstView: builtin?.cameras[0] ?? null,
    ownCameras: null,
    about: null,
    isUpsideDown: !builtin && isUpsideDown(cloud),
  });
  const large = largePly(source, options.keepAboveBytes);
  if (large) {
    const { loadKept } = await import('./load-kept.ts');
    const onSample = (sample: SplatCloud) => options.onPreview(sceneOf(sample));
    const kept = await loadKept(engine, large, { signal, onProgress, onSample });
    if (kept) return { ...sceneOf(kept.cloud), sampleFailure: kept.failure };
  }
  const cloud = await engine.load(fileOf(source), {
    name: titleOf(source),
    // Users who open a file of their own want to see all of it.
    maxSplats: source.kind === 'file' ? Number.POSITIVE_INFINITY : undefined,
    fit: 'auto',
    signal,
    onProgress,
    onPreview: (preview) => options.onPreview(sceneOf(preview)),
  });
  return sceneOf(cloud);
}

function largePly(source: SceneSource, keepAboveBytes: number): File | null {
  if (source.kind !== 'file' || !(source.source instanceof File)) return null;
  const { name, size } = source.source;
  return size > keepAboveBytes && /\.ply$/i.test(name) ? source.source : null;
}

function fileOf(source: Exclude<SceneSource, { kind: 'hard-case' }>): File | SceneFiles | URL {
  switch (source.kind) {
    case 'builtin':
      return source.scene.url;
    case 'file':
      return source.source;
    case 'url':
      return source.url;
  }
}

/** Captures mostly have y pointing down; glTF has it up by definition. */
function isUpsideDown({ facts }: SplatCloud): boolean {
  return facts.fileFacts?.format !== 'gltf';
}
