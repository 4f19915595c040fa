import { readFile } from 'node:fs/promises';
import { builtinScenes } from '@websplatter/scenes';
import { filterSplats } from '../data/editing/crop-splats.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { readSplats } from '../io/loading/read-splats.ts';

/** Every `step`th of some splats. */
export function everyOf(set: SplatSet<Harmonics>, step: number): SplatSet<Harmonics> {
  return filterSplats(set, (index) => index % step === 0);
}

/** A built-in scene: 10,000 splats of degree 3, or 150,000 with a palette. */
export async function stillLife(
  wanted: 'still-life' | 'still-life-small' = 'still-life-small',
): Promise<SplatSet<Harmonics>> {
  const { url } = builtinScenes.find(({ name }) => name === wanted)!;
  return readSplats(new Blob([await readFile(url)]));
}
