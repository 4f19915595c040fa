import type { Camera, CloudInstance, LoadProgress, SplatEngine } from '@websplatter/core';
import type { BuiltinScene, SceneCamera } from '@websplatter/scenes';
import { findHardCase, groupTitle, loadHardCases } from '../hard-cases/catalogue.ts';
import { baseName } from '../words/format.ts';
import { makeBuiltinScene } from './builtin-scene.ts';

/** Where a scene comes from; kept, so that it can be read again. */
export type SceneSource =
  | { readonly kind: 'builtin'; readonly scene: BuiltinScene }
  | { readonly kind: 'file'; readonly file: File }
  | { readonly kind: 'url'; readonly url: URL }
  | { readonly kind: 'hard-case'; readonly name: string };

/** What a scene is for, where it is there to show something. */
export interface SceneAbout {
  readonly topic: string;
  readonly text: string;
}

/** A scene on the GPU, and how it wants to be looked at. */
export interface LoadedScene {
  readonly clouds: readonly CloudInstance[];
  /** Where to begin; null: at a distance from which all can be seen. */
  readonly firstView: SceneCamera | null;
  /**
   * Cameras whose very pictures the scene is about, by name, for a picture of this aspect ratio. Orbiting need not be
   * able to make them: they may be orthographic, off-centre or mirrored.
   */
  readonly ownCameras: ((aspect: number) => Readonly<Record<string, Camera>>) | null;
  readonly about: SceneAbout | null;
  /** Its y axis points down, as in captures that were solved with computer-vision conventions. */
  readonly isUpsideDown: boolean;
}

export function titleOf(source: SceneSource): string {
  switch (source.kind) {
    case 'builtin':
      return source.scene.title;
    case 'file':
      return source.file.name;
    case 'url':
      return baseName(source.url.href);
    case 'hard-case':
      return source.name;
  }
}

/** Makes or reads `source` and uploads it. Where that fails or is called off, nothing stays on the GPU. */
export async function loadScene(
  engine: SplatEngine,
  source: SceneSource,
  signal: AbortSignal,
  onProgress: (progress: LoadProgress) => void,
): Promise<LoadedScene> {
  const plain = { firstView: null, ownCameras: null, about: null };
  if (source.kind === 'builtin') {
    const { name, title, cameras } = source.scene;
    const { packed, set } = await makeBuiltinScene(name, engine.accuracy, signal);
    const clouds = [{ cloud: engine.addPacked(packed, { name: title, source: set }) }];
    return { ...plain, clouds, firstView: cameras[0], isUpsideDown: false };
  }
  if (source.kind === 'hard-case') return loadHardCase(engine, source.name, signal, onProgress);
  const cloud = await engine.load(source.kind === 'file' ? source.file : source.url, {
    name: titleOf(source),
    signal,
    onProgress,
  });
  return { ...plain, clouds: [{ cloud }], isUpsideDown: true };
}

async function loadHardCase(
  engine: SplatEngine,
  name: string,
  signal: AbortSignal,
  onProgress: (progress: LoadProgress) => void,
): Promise<LoadedScene> {
  const hardCase = findHardCase(await loadHardCases(), name);
  const loadFile = (file: Uint8Array) => engine.load(file, { name, signal, onProgress });
  const clouds: CloudInstance[] = [];
  try {
    signal.throwIfAborted();
    if (hardCase.kind === 'refused-file') {
      clouds.push({ cloud: await loadFile(hardCase.file()) });
    } else {
      for (const splats of hardCase.clouds()) {
        const cloud = 'file' in splats ? await loadFile(splats.file) : engine.add(splats.set, { name });
        clouds.push({ cloud, modelMatrix: splats.modelMatrix });
      }
    }
  } catch (error) {
    for (const { cloud } of clouds) cloud.destroy();
    throw error;
  }
  return {
    clouds,
    firstView: null,
    ownCameras: hardCase.kind === 'refused-file' ? null : hardCase.cameras,
    about: { topic: groupTitle(hardCase.group), text: hardCase.breaks },
    isUpsideDown: false,
  };
}
