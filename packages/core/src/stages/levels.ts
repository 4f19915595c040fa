/** Loads the texts that stages need for levels of detail and for instances. They come together. */
export const levelTexts = () => import('./levels.texts.ts');
