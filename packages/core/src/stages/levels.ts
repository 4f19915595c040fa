/** Loads the WGSL that stages need for levels of detail and for instances, as one script. */
export const levelTexts = () => import('./levels.texts.ts');
