import type { LEVEL_TEXTS } from './level-texts.ts';
import type { LaterTexts } from './link-shader.ts';
import type { RARE_TEXTS } from './rare-texts.ts';
import type { TILE_TEXTS } from './tile-texts.ts';
import type { WIDE_KEY_TEXTS } from './wide-key-texts.ts';

const loadTiles = () => import('./tile-texts.ts');

/** Returns a function that loads the text of a stage of the tiles. All of them come together. */
export function tileSource(stage: keyof typeof TILE_TEXTS): () => Promise<LaterTexts> {
  return async () => {
    const { TILE_TEXTS, TILE_LIBRARIES: libraries } = await loadTiles();
    return { source: TILE_TEXTS[stage], libraries };
  };
}

/** Prefetches the texts of the tile stages while a device is requested. `tileSource` rejects if it fails. */
export function foreseeTiles(): void {
  loadTiles().catch(() => {});
}

/** Returns a function that loads the text of a stage that most pages never run. */
export function rareSource(stage: keyof typeof RARE_TEXTS): () => Promise<LaterTexts> {
  return async () => {
    const { RARE_TEXTS, RARE_LIBRARIES: libraries } = await import('./rare-texts.ts');
    return { source: RARE_TEXTS[stage], libraries };
  };
}

/** Returns a function that loads the text of a stage that makes or draws levels, or draws instances. */
export function levelSource(stage: keyof typeof LEVEL_TEXTS): () => Promise<LaterTexts> {
  return async () => {
    const [{ LEVEL_TEXTS, LEVEL_LIBRARIES: libraries }, { LEVEL_STRUCTS: structs }] = await Promise.all([
      import('./level-texts.ts'),
      import('../../data/layout/level-structs.ts'),
    ]);
    return { source: LEVEL_TEXTS[stage], libraries, structs };
  };
}

/** Returns a function that loads the text of a stage that only sorting by float64 runs. */
export function wideKeySource(stage: keyof typeof WIDE_KEY_TEXTS): () => Promise<LaterTexts> {
  return async () => {
    const [{ WIDE_KEY_TEXTS, WIDE_KEY_LIBRARIES: libraries }, { WidePlace }] = await Promise.all([
      import('./wide-key-texts.ts'),
      import('../../data/layout/wide-place.ts'),
    ]);
    return { source: WIDE_KEY_TEXTS[stage], libraries, structs: [WidePlace] };
  };
}
