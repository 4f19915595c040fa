import keepColors from '../../../../shaders/stages/keep-colors.wgsl?raw';
import resolveDepth from '../../../../shaders/stages/resolve-depth.wgsl?raw';
import upscale from '../../../../shaders/stages/upscale.wgsl?raw';

/** Texts of stages that most pages never run. */
export const RARE_TEXTS = {
  'keep-colors': keepColors,
  'resolve-depth': resolveDepth,
  upscale,
} as const;
