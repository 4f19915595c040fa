import { familyTexts } from '../family-texts.ts';

export const { modules, structs } = familyTexts(
  import.meta.glob(
    [
      './*.wgsl',
      '../../../../../shaders/lib/{layer-rounding,splat-ellipse,tile-blend,tile-grid,workgroup-scan}.wgsl',
    ],
    { query: '?raw', import: 'default', eager: true },
  ),
);
