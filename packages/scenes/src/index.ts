/**
 * Scenes to look at before you have a capture, and random ones to measure with.
 *
 * @module
 */
export {
  type BuiltinScene,
  builtinScenes,
  type SceneCamera,
  stillLifeCameras,
} from './builtin-scenes.ts';
export {
  SYNTHETIC_MAX_SPLATS,
  SYNTHETIC_MIN_SPLATS,
  type SyntheticOptions,
  syntheticCamera,
  syntheticPly,
} from './synthetic.ts';
