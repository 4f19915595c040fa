import { LEVEL_STRUCTS } from '../data/layout/level-structs.ts';
import { familyTexts } from './family-texts.ts';

export const { modules, structs } = familyTexts(
  import.meta.glob(
    [
      './{cut,merge}/*.wgsl',
      '../../../../shaders/lib/{dilated-blob,harmonics-packing,instances,level-link,merged-cell,merged-splat,pack-splat}.wgsl',
    ],
    { query: '?raw', import: 'default', eager: true },
  ),
  LEVEL_STRUCTS,
);
