import { familyTexts } from '../family-texts.ts';

export const { modules, structs } = familyTexts(
  import.meta.glob(['./*.wgsl', '../../../../../shaders/lib/layer-rounding.wgsl'], {
    query: '?raw',
    import: 'default',
    eager: true,
  }),
);
