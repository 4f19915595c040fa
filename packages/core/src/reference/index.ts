export { type CompareOptions, compareImages, type ImageDifference } from './compare-images.ts';
export type { ReferenceImage } from './rasterize.ts';
export { type ReferenceFrame, renderReference } from './render.ts';
