/** In one file: neither is needed before the first picture. */
export { keepStory } from '../navigate/keep-story.ts';
export { mirrorToAddress } from './address-mirror.ts';
