import { type CloudInstance, type SplatEngine, SplatFileError } from '@websplatter/core';
import { groupTitle } from '@websplatter/kit/hard-cases';
import { orbitNear } from '../../camera/orbit-near.ts';
import { findHardCase, loadHardCases } from './catalogue.ts';
import type { LoadedScene, LoadSceneOptions } from './shown-scene.ts';

/** Generates the stress-test scene (hard case) with this name. Throws and cancels as `loadScene` does. */
export async function loadHardCase(
  engine: SplatEngine,
  name: string,
  { signal, onProgress }: LoadSceneOptions,
): Promise<LoadedScene> {
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
    for (const { cloud } of clouds) cloud.destroy();
    throw error;
  }
  return {
    clouds,
    firstView: null,
    ownCameras:
      hardCase.kind === 'scene' || hardCase.kind === 'device' ? { at: hardCase.cameras, orbitNear } : null,
    about: { topic: groupTitle(hardCase.group), text: hardCase.breaks },
    refusal,
    isUpsideDown: false,
  };
}
