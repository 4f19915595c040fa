import type { SplatSet } from '@websplatter/core';
import { type SceneCamera, stillLifeCameras } from './cameras.ts';
import { STILL_LIFE_SPLATS, stillLife } from './still-life.ts';

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
export { type SceneCamera, stillLifeCameras };

/** A scene made by code. */
export interface BuiltinScene {
  /** Identifier for command lines and addresses. */
  readonly name: string;
  /** Human-readable title. */
  readonly title: string;
  /** Number of splats that {@link make} returns. */
  readonly splats: number;
  /** Good views; the first is where to start. */
  readonly cameras: readonly SceneCamera[];
  make(): SplatSet;
}

const SMALL_SPLATS = 10_000;

export const builtinScenes: readonly BuiltinScene[] = [
  {
    name: 'still-life',
    title: 'Still life',
    splats: STILL_LIFE_SPLATS,
    cameras: stillLifeCameras,
    make: () => stillLife(),
  },
  {
    name: 'still-life-small',
    title: 'Still life, small',
    splats: SMALL_SPLATS,
    cameras: stillLifeCameras,
    make: () => stillLife({ splats: SMALL_SPLATS }),
  },
];
