import type { FrameRasterizer } from '../data/accuracy/accuracy.ts';
import type { RasterizerChoiceOptions } from './rasterizer-choice.ts';

const KEY = 'websplatter faster rasterizer';

/** Faster rasteriser by adapter, for this page; local storage keeps it for later pages. */
const choices = new Map<string, FrameRasterizer>();

/** The rasteriser last found faster on an adapter, and a function to store it. */
export function rememberedRasterizer(
  adapterLabel: string,
): Pick<RasterizerChoiceOptions, 'remembered' | 'remember'> {
  const key = `${KEY} ${adapterLabel}`;
  return {
    remembered: choices.get(adapterLabel) ?? stored(key),
    remember: (rasterizer) => {
      if (choices.get(adapterLabel) === rasterizer) return;
      choices.set(adapterLabel, rasterizer);
      try {
        storage()?.setItem(key, rasterizer);
      } catch {
        // A full or forbidden storage only costs the next page a comparison.
      }
    },
  };
}

function stored(key: string): FrameRasterizer | null {
  try {
    const value = storage()?.getItem(key);
    return value === 'tiles' || value === 'quads' ? value : null;
  } catch {
    // A page that may not use storage compares the rasterisers itself.
    return null;
  }
}

/** Null in workers and in Node. Throws on pages that may not use storage. */
function storage(): Storage | null {
  return typeof window === 'undefined' ? null : window.localStorage;
}
