import type { TimedPass } from '@websplatter/core';

/** Passes by the stage that they belong to, as people call them. None: a pass besides the image. */
export const PASSES: readonly (readonly [TimedPass, string])[] = [
  ['preprocess', 'Cull, project, colour'],
  ['sort', 'Sort by depth'],
  ['tile-lists', 'List splats by tile'],
  ['tiles', 'Blend by tiles'],
  ['rasterize', 'Blend as quads'],
  ['upscale', 'Enlarge'],
  ['composite', 'Lay over background'],
  ['quads-sample', 'Sample of quads, to compare'],
];
