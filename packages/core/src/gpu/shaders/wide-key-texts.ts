import float64 from '../../../../../shaders/lib/float64.wgsl?raw';
import instances from '../../../../../shaders/lib/instances.wgsl?raw';
import sortGather from '../../../../../shaders/stages/sort-gather.wgsl?raw';
import wideKeys from '../../../../../shaders/stages/wide-keys.wgsl?raw';

/** Texts of the stages that sort by float64 needs besides others. */
export const WIDE_KEY_TEXTS = { 'sort-gather': sortGather, 'wide-keys': wideKeys } as const;

/** Texts of what they import and the engine’s own stages do not. */
export const WIDE_KEY_LIBRARIES = { 'lib/float64': float64, 'lib/instances': instances } as const;
