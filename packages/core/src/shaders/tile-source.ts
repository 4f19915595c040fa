import type { TILE_TEXTS } from './tile-texts.ts';

const load = () => import('./tile-texts.ts');

/** Returns a function that loads the text of a stage of the tiles. All of them come together. */
export function tileSource(stage: keyof typeof TILE_TEXTS): () => Promise<string> {
  return async () => (await load()).TILE_TEXTS[stage];
}

/** Starts loading the texts, so that they arrive while a device is asked for. Who needs them then waits for them, or asks again. */
export function foreseeTiles(): void {
  load().catch(() => {});
}
