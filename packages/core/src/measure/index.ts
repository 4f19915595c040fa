export type { ImageDifference } from '../reference/compare-images.ts';
export { comparePictures } from './compare-pictures.ts';
export { NonFinitePictureError } from './compare-textures.ts';
