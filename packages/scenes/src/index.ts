import type { SplatSet } from '@websplatter/core';
import { type BuiltinSceneFacts, builtinSceneFacts } from './builtin-scene-facts.ts';
import { type SceneCamera, stillLifeCameras } from './cameras.ts';
import { stillLife, stillLifeShare } from './still-life.ts';

export {
  STILL_LIFE_MAX_SPLATS,
  STILL_LIFE_MIN_SPLATS,
  type StillLifeOptions,
  stillLife,
} from './still-life.ts';
export {
  SYNTHETIC_MAX_SPLATS,
  SYNTHETIC_MIN_SPLATS,
  type SyntheticOptions,
  syntheticCamera,
  syntheticPly,
} from './synthetic.ts';
export { type BuiltinSceneFacts, builtinSceneFacts, type SceneCamera, stillLifeCameras };

/** A scene made by code. */
export interface BuiltinScene extends BuiltinSceneFacts {
  /** Makes as many splats as {@link BuiltinSceneFacts.splats} says. */
  make(): SplatSet;
  /**
   * Makes one of `of` shares of about equal work, so that several workers make a scene: `mergeSplats` of all of them in order is
   * what {@link make} returns.
   *
   * @param share 0 to `of` − 1
   * @throws RangeError for a share that does not exist
   */
  makeShare(share: number, of: number): SplatSet;
}

export const builtinScenes: readonly BuiltinScene[] = builtinSceneFacts.map((facts) => ({
  ...facts,
  make: () => stillLife({ splats: facts.splats }),
  makeShare: (share, of) => stillLifeShare(share, of, { splats: facts.splats }),
}));
