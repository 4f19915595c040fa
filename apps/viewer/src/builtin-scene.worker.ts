/** Makes and packs a built-in scene off the main thread, so that the page stays responsive. */
import { type AccuracySettings, packCloud, repackShRest, transferablesOf } from '@websplatter/core';
import { builtinScenes } from '@websplatter/scenes';

export interface SceneRequest extends Pick<AccuracySettings, 'geometryPrecision' | 'shPrecision'> {
  readonly name: string;
}

self.onmessage = ({ data }: MessageEvent<SceneRequest>) => {
  const { name, geometryPrecision, shPrecision } = data;
  const scene = builtinScenes.find((candidate) => candidate.name === name);
  if (!scene) throw new Error(`There is no built-in scene "${name}".`);
  const set = scene.make();
  const shRest = repackShRest(set.shRest, set.count, shPrecision);
  const packed = packCloud({ ...set, shRest }, { geometryPrecision });
  self.postMessage(packed, { transfer: transferablesOf(packed) });
};
