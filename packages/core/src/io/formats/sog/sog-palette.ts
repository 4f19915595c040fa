import { SplatFileError } from '../../../data/errors.ts';
import { type HarmonicsPalette, MAX_PALETTE_ENTRIES } from '../../../data/packing/harmonics-palette.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import type { SogImages, SogPaletteImages } from './sog-images.ts';
import type { SogMeta } from './sog-meta.ts';

/** A SOG, which may be a part of a scene. */
export interface SogUnit {
  /** Name of its metadata in messages. */
  readonly file: string;
  readonly meta: SogMeta;
  readonly images: SogImages;
}

/**
 * Concatenates the palettes of a scene's parts. Parts of lower degree, or without harmonics, are
 * padded with zeros. Null if the palette has too many entries for its indices, or an entry that is
 * not finite.
 *
 * @throws SplatFileError 'damaged'
 */
export function joinPalettes(units: readonly SogUnit[], degree: ShDegree): HarmonicsPalette | null {
  const sizes = units.map(({ images }) => sizeOf(images));
  const count = sizes.reduce((sum, size) => sum + size, 0);
  if (degree === 0 || count > MAX_PALETTE_ENTRIES) return null;
  const length = coefficientsPerSplat(degree);
  const entries = new Float32Array(count * length);
  const indices = new Uint16Array(units.reduce((sum, { meta }) => sum + meta.count, 0));
  let firstEntry = 0;
  let firstSplat = 0;
  for (const [i, unit] of units.entries()) {
    const own = unit.images.harmonics && paletteEntries(unit);
    const ownLength = own ? own.length / sizes[i] : 0;
    for (let entry = 0; own && entry < sizes[i]; entry++) {
      const values = own.subarray(entry * ownLength, (entry + 1) * ownLength);
      entries.set(values, (firstEntry + entry) * length);
    }
    const labels = labelsOf(unit);
    for (let splat = 0; splat < labels.length; splat++)
      indices[firstSplat + splat] = firstEntry + labels[splat];
    firstEntry += sizes[i];
    firstSplat += labels.length;
  }
  return entries.every(Number.isFinite) ? { degree, entries, indices } : null;
}

/** Coefficients of all entries, k-major as in rows. */
export function paletteEntries({ meta, images }: SogUnit): Float32Array {
  const { values } = meta.harmonics!;
  const { degree, palette } = images.harmonics!;
  const pixels = (sizeOf(images) * coefficientsPerSplat(degree)) / 3;
  const entries = new Float32Array(3 * pixels);
  for (let pixel = 0; pixel < pixels; pixel++) {
    entries[3 * pixel] = values[palette[4 * pixel]];
    entries[3 * pixel + 1] = values[palette[4 * pixel + 1]];
    entries[3 * pixel + 2] = values[palette[4 * pixel + 2]];
  }
  return entries;
}

/** Palette index per splat; all 0 if there is no palette. @throws SplatFileError 'damaged' */
export function labelsOf({ file, meta: { count }, images: { harmonics } }: SogUnit): Uint16Array {
  const indices = new Uint16Array(count);
  if (!harmonics) return indices;
  const { labels, size } = harmonics;
  for (let splat = 0; splat < count; splat++) {
    const label = labels[4 * splat] | (labels[4 * splat + 1] << 8);
    if (label >= size) throw labelError(file, splat, label, size);
    indices[splat] = label;
  }
  return indices;
}

/** Number of entries; a part without harmonics has one entry of zeros. */
function sizeOf({ harmonics }: { readonly harmonics: SogPaletteImages | null }): number {
  return harmonics?.size ?? 1;
}

function labelError(file: string, row: number, label: number, size: number): SplatFileError {
  const message = `a splat has the harmonics ${label} of a palette of ${size}. Export the scene again.`;
  return new SplatFileError('damaged', file, message, { row });
}
