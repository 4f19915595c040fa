import layerRounding from '../../../../../shaders/lib/layer-rounding.wgsl?raw';
import compose from '../../../../../shaders/stages/compose.wgsl?raw';
import resolveDepth from '../../../../../shaders/stages/resolve-depth.wgsl?raw';
import upscale from '../../../../../shaders/stages/upscale.wgsl?raw';

/** Texts of stages that most pages never run, and of stages that draw over a host's image. */
export const RARE_TEXTS = {
  compose,
  'resolve-depth': resolveDepth,
  upscale,
} as const;

/** Modules that only the stages above import, and no stage in the engine's own code. */
export const RARE_LIBRARIES = { 'lib/layer-rounding': layerRounding } as const;
