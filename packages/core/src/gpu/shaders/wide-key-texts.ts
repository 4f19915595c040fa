import float64 from '../../../../../shaders/lib/float64.wgsl?raw';
import instances from '../../../../../shaders/lib/instances.wgsl?raw';
import sortGather from '../../../../../shaders/stages/sort-gather.wgsl?raw';
import wideKeys from '../../../../../shaders/stages/wide-keys.wgsl?raw';

/** Texts of the stages that only sorting by float64 runs. */
export const WIDE_KEY_TEXTS = { 'sort-gather': sortGather, 'wide-keys': wideKeys } as const;

/** Modules that only the stages above import, and no stage in the engine's own code. */
export const WIDE_KEY_LIBRARIES = { 'lib/float64': float64, 'lib/instances': instances } as const;
