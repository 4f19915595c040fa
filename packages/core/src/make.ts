/**
 * Splats from images and text (`@websplatter/core/make`), apart from the engine: pages that only show
 * files do not download it.
 *
 * @module
 */
export {
  type ImagePixels,
  type ImageSplatsOptions,
  type SplatImage,
  splatsFromImage,
} from './data/editing/splats-from-image.ts';
export { splatsFromText, type TextSplatsOptions } from './data/editing/splats-from-text.ts';
