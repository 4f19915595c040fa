import {
  type CloudInstance,
  type LoadOptions,
  type SceneFiles,
  type SplatCloud,
  type SplatEngine,
  SplatFileError,
} from '@websplatter/core';
import { isProbablyZUp } from '../camera/up-axis.ts';
import type { CameraSubject } from '../camera/view-camera.ts';
import type { SceneAbout } from '../state/scene-summary.ts';
import { type SceneSource, titleOf } from './scene-source.ts';

/** A scene on the GPU, and how it is to be looked at. */
export interface LoadedScene
  extends Pick<CameraSubject, 'firstView' | 'ownCameras' | 'isUpsideDown' | 'isZUp'> {
  readonly clouds: readonly CloudInstance[];
  readonly about: SceneAbout | null;
  /** Why a file has no splats whose refusal is what the scene shows. */
  readonly refusal?: SplatFileError;
}

export interface LoadSceneOptions extends Pick<LoadOptions, 'onProgress'> {
  readonly signal: AbortSignal;
  /** Called with what can be shown already, again and again: see `LoadOptions.onPreview`. */
  readonly onPreview: (preview: LoadedScene) => void;
}

/** Reads or makes `source` and uploads it. A failed or cancelled load leaves nothing on the GPU. */
export async function loadScene(
  engine: SplatEngine,
  source: SceneSource,
  options: LoadSceneOptions,
): Promise<LoadedScene> {
  const { signal, onProgress } = options;
  if (source.kind === 'hard-case') return loadHardCase(engine, source.name, options);
  const builtin = source.kind === 'builtin' ? source.scene : null;
  const sceneOf = (cloud: SplatCloud) => ({
    clouds: [{ cloud }],
    firstView: builtin?.cameras[0] ?? null,
    ownCameras: null,
    about: null,
    isUpsideDown: !builtin && isUpsideDown(cloud),
    isZUp: false,
  });
  /** The part of a file that has arrived need not have the shape of the whole. */
  const wholeSceneOf = (cloud: SplatCloud) => ({ ...sceneOf(cloud), isZUp: !builtin && isZUp(cloud) });
  const cloud = await engine.load(fileOf(source), {
    name: titleOf(source),
    // People who open a file of their own want to see all of it.
    maxSplats: source.kind === 'file' ? Number.POSITIVE_INFINITY : undefined,
    fit: 'auto',
    signal,
    onProgress,
    onPreview: (preview) => options.onPreview(sceneOf(preview)),
  });
  return wholeSceneOf(cloud);
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

export function destroyClouds({ clouds }: Pick<LoadedScene, 'clouds'>): void {
  for (const { cloud } of clouds) cloud.destroy();
}

/** Captures mostly have y pointing down; glTF has it up by definition. */
function isUpsideDown({ facts }: SplatCloud): boolean {
  return facts.fileFacts?.format !== 'gltf';
}

/** The shape of the scene may say which way is up if the file does not. */
function isZUp(cloud: SplatCloud): boolean {
  return isUpsideDown(cloud) && isProbablyZUp(cloud.robustBounds);
}

async function loadHardCase(
  engine: SplatEngine,
  name: string,
  { signal, onProgress }: LoadSceneOptions,
): Promise<LoadedScene> {
  const { findHardCase, groupTitle, loadHardCases } = await import('../hard-cases/catalogue.ts');
  const hardCase = findHardCase(await loadHardCases(), name);
  const loadFile = (file: Uint8Array) => engine.load(file, { name, signal, onProgress });
  const clouds: CloudInstance[] = [];
  let refusal: SplatFileError | undefined;
  try {
    signal.throwIfAborted();
    if (hardCase.kind === 'refused-file') {
      try {
        clouds.push({ cloud: await loadFile(hardCase.file()) });
      } catch (error) {
        if (!(error instanceof SplatFileError)) throw error;
        refusal = error;
      }
    } else {
      for (const splats of hardCase.clouds()) {
        const cloud = 'file' in splats ? await loadFile(splats.file) : engine.add(splats.set, { name });
        clouds.push({ cloud, modelMatrix: splats.modelMatrix });
      }
    }
  } catch (error) {
    destroyClouds({ clouds });
    throw error;
  }
  return {
    clouds,
    firstView: null,
    ownCameras: hardCase.kind === 'refused-file' ? null : hardCase.cameras,
    isZUp: false,
    about: { topic: groupTitle(hardCase.group), text: hardCase.breaks },
    refusal,
    isUpsideDown: false,
  };
}
