import { describe, expect, test } from 'vitest';
import { ownHarmonics } from '../../testing/own-harmonics.ts';
import { paletteSplats, withOwnCoefficients } from '../../testing/palette-splats.ts';
import { COEFFICIENT_MAX } from '../layout/half.ts';
import { coefficientsPerSplat, type ShDegree } from '../splats/splat-set.ts';
import { shBandReach } from './band-reach.ts';
import { dropNonFinite } from './drop-non-finite.ts';
import { type Harmonics, paletteWordsOf, readCoefficients, shWordsPerSplat } from './harmonics.ts';
import { MAX_PALETTE_ENTRIES } from './harmonics-palette.ts';
import { packSet } from './pack-set.ts';
import { type PackedCloud, packCloud, transferablesOf } from './packed-cloud.ts';
import { SH_PRECISIONS } from './precision.ts';
import { packPalette } from './repack-harmonics.ts';
import { shPlaneBytes } from './sh-plane-bytes.ts';

const DEGREES: readonly ShDegree[] = [1, 2, 3];

function valuesOf(harmonics: Harmonics, count: number): number[][] {
  const values = new Float64Array(coefficientsPerSplat(harmonics.degree));
  return Array.from({ length: count }, (_, i) => {
    readCoefficients(harmonics, i, values);
    return [...values];
  });
}

function paletteOf({ harmonics }: PackedCloud) {
  if (harmonics.precision !== 'palette') throw new Error(`${harmonics.precision} instead of a palette`);
  return harmonics;
}

describe('a palette', () => {
  test.each(DEGREES)('of degree %i stands for the coefficients of each splat', (shDegree) => {
    const set = paletteSplats({ count: 40, entryCount: 7, shDegree });
    const own = withOwnCoefficients(set);
    expect(valuesOf(set.harmonics, 40)).toEqual(valuesOf(own.harmonics, 40));
    const packed = packPalette(set.harmonics, shDegree);
    expect(valuesOf(packed, 40)).toEqual(valuesOf(own.harmonics, 40));
    const clamped = packPalette(
      { ...set.harmonics, entries: set.harmonics.entries.map(() => 3e38) },
      shDegree,
    );
    expect(clamped.entries[0]).toBe(Math.fround(COEFFICIENT_MAX));
  });

  test('reaches as far as its entries', () => {
    const set = paletteSplats({ count: 300, entryCount: 5 });
    const own = withOwnCoefficients(set);
    // Of those that splats have.
    const { entries } = set.harmonics;
    const more = { ...set.harmonics, entries: Float32Array.of(...entries, ...new Array(45).fill(9)) };
    expect(shBandReach(more, 300)).toEqual(shBandReach(own.harmonics, 300));
  });

  test.each(SH_PRECISIONS)('stays one where %s is wanted, in the order of storage', (shPrecision) => {
    const set = paletteSplats({ count: 600, entryCount: 9 });
    const packed = packSet(set, { geometryPrecision: 'packed', shPrecision });
    const own = packSet(withOwnCoefficients(set), { geometryPrecision: 'packed', shPrecision: 'f32' });
    expect(packed.fileIndices).toEqual(own.fileIndices);
    expect(valuesOf(packed.harmonics, 600)).toEqual(valuesOf(own.harmonics, 600));
    const { paletteEntries, ...facts } = packed.facts;
    expect(paletteEntries).toBe(9);
    expect(own.facts).toEqual({ ...facts, paletteEntries: null });
  });

  test('loses bands that cannot be seen', () => {
    const set = paletteSplats({ count: 300, entryCount: 4 });
    for (const [at] of set.harmonics.entries.entries()) if (at % 45 >= 9) set.harmonics.entries[at] = 1e-6;
    const packed = packCloud(set, { geometryPrecision: 'packed' });
    expect(packed.facts).toMatchObject({ declaredShDegree: 3, trueShDegree: 1, paletteEntries: 4 });
    expect(paletteOf(packed).entries).toHaveLength(4 * shWordsPerSplat(1, 'f32'));
    set.harmonics.entries.fill(0);
    const none = packCloud(set, { geometryPrecision: 'packed' });
    expect(paletteOf(none)).toMatchObject({ degree: 0, entries: new Float32Array(0) });
  });

  test('loses rows that are not finite, of its own entries too', () => {
    const set = paletteSplats({ count: 50, entryCount: 3 });
    set.harmonics.entries[2 * 45] = Number.NaN;
    set.positions[3] = Number.POSITIVE_INFINITY;
    const kept = dropNonFinite(set);
    const left = Array.from(set.harmonics.indices, (entry, i) =>
      i === 1 || entry === 2 ? [] : entry,
    ).flat();
    expect([...kept.harmonics.indices]).toEqual(left);
    expect(kept.count).toBe(left.length);
    expect(kept.dropped['non-finite-position']).toBe(1);
  });

  test('does not replace harmonics of single splats: they get the next finer precision', () => {
    const set = withOwnCoefficients(paletteSplats({ count: 10, entryCount: 3 }));
    const { harmonics } = packSet(set, { geometryPrecision: 'packed', shPrecision: 'palette' });
    expect(ownHarmonics(harmonics).precision).toBe('u8');
  });

  test('is posted without a copy', () => {
    const packed = packSet(paletteSplats({ count: 10, entryCount: 3 }), {
      geometryPrecision: 'f32',
      shPrecision: 'palette',
    });
    const { entries, indices } = paletteOf(packed);
    expect(transferablesOf(packed)).toEqual(
      expect.arrayContaining([entries.buffer, indices.buffer, packed.chunks]),
    );
    const { harmonics } = structuredClone(packed, { transfer: transferablesOf(packed) });
    expect(valuesOf(harmonics, 10)).toHaveLength(10);
  });

  test.each([
    [1, 1],
    [255, 3],
    [6, MAX_PALETTE_ENTRIES],
  ])(
    'of %i splats and %i entries: a page has all entries, and two indices to a word',
    (count, entryCount) => {
      const { harmonics } = paletteSplats({ count, entryCount, shDegree: 1 });
      const packed = packPalette(harmonics, 1);
      const page = paletteWordsOf(packed)(0, count);
      expect(4 * page.length).toBe(shPlaneBytes(count, 1, 'palette', entryCount));
      // Element by element, `toEqual` takes seconds.
      const floats = new Float32Array(page.buffer);
      expect(packed.entries.every((value, i) => value === floats[i])).toBe(true);
      for (let i = 0; i < count; i++)
        expect((page[9 * entryCount + (i >> 1)] >>> (16 * (i & 1))) & 0xffff).toBe(harmonics.indices[i]);
      expect(harmonics.indices[0]).toBe(entryCount - 1);
    },
  );

  test('takes no bytes at degree 0', () => {
    expect(shPlaneBytes(100, 0, 'palette', 5)).toBe(0);
    expect(shPlaneBytes(100, 3, 'u8')).toBe(4800);
  });
});
