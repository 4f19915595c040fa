import exactExp from '../../../../../shaders/lib/exact-exp.wgsl?raw';
import floatBits from '../../../../../shaders/lib/float-bits.wgsl?raw';
import harmonicsPacking from '../../../../../shaders/lib/harmonics-packing.wgsl?raw';
import packSplat from '../../../../../shaders/lib/pack-splat.wgsl?raw';

/** Files that only stages which pack splats import, and that come with those. */
export const PACKING_LIBRARIES = {
  'lib/exact-exp': exactExp,
  'lib/float-bits': floatBits,
  'lib/harmonics-packing': harmonicsPacking,
  'lib/pack-splat': packSplat,
} as const;
