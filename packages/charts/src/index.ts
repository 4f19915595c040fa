export { boxAround, type LabelBox, LabelSpace } from './label-space.ts';
