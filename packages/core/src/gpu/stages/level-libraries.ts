import levelLink from '../../../../../shaders/lib/level-link.wgsl?raw';
import mergedSplat from '../../../../../shaders/lib/merged-splat.wgsl?raw';

/** Files that only stages which know levels import, and that come with those. */
export const LEVEL_LIBRARIES = { 'lib/level-link': levelLink, 'lib/merged-splat': mergedSplat } as const;
