import { WidePlace } from '../../data/layout/wide-place.ts';
import { familyTexts } from '../family-texts.ts';

export const { modules, structs } = familyTexts(
  import.meta.glob(['./*.wgsl', '../../../../../shaders/lib/{float64,instances}.wgsl'], {
    query: '?raw',
    import: 'default',
    eager: true,
  }),
  [WidePlace],
);
