import type { SplatSet } from '@websplatter/core';
import { type BuiltinScene, builtinScenes } from '@websplatter/scenes';

/** The splats of a built-in scene. Brings the code of all of them, and takes its time: for workers. */
export function makeBuiltin(name: string): SplatSet {
  return builtinScene(name).make();
}

export function builtinScene(name: string): BuiltinScene {
  const scene = builtinScenes.find((candidate) => candidate.name === name);
  if (!scene) throw new Error(`There is no built-in scene "${name}".`);
  return scene;
}
