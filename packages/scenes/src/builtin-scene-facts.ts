import { type SceneCamera, stillLifeCameras } from './cameras.ts';

/** What is known of a scene made by code before it is made. */
export interface BuiltinSceneFacts {
  /** Identifier for command lines and addresses. */
  readonly name: string;
  /** Human-readable title. */
  readonly title: string;
  /** Number of splats. */
  readonly splats: number;
  /** Good views; the first is where to start. */
  readonly cameras: readonly SceneCamera[];
}

/** Splats of the still life at its full size. */
export const STILL_LIFE_SPLATS = 150_000;
const SMALL_SPLATS = 10_000;

/** The scenes of `builtinScenes`, without the code that makes them: a page may leave that to a worker. */
export const builtinSceneFacts: readonly BuiltinSceneFacts[] = [
  { name: 'still-life', title: 'Still life', splats: STILL_LIFE_SPLATS, cameras: stillLifeCameras },
  { name: 'still-life-small', title: 'Still life, small', splats: SMALL_SPLATS, cameras: stillLifeCameras },
];
