import { givenSet } from '../splats/check-set.ts';
import type { FileFacts, ShDegree, SplatColumns, SplatSet } from '../splats/splat-set.ts';
import { shBandReach } from './band-reach.ts';
import { entryCountOf, type Harmonics, isPalette } from './harmonics.ts';

/** Facts about a cloud's splats that hold from any viewpoint, found when they are packed. */
export interface CloudFacts {
  /** Degree of the spherical harmonics in the file. */
  readonly declaredShDegree: ShDegree;
  /**
   * Degree of the harmonics that can be seen: only these are stored and drawn. All bands above it
   * together change no channel of any splat's colour by as much as UNSEEN_CHANGE.
   */
  readonly trueShDegree: ShDegree;
  /**
   * For each band 1…declaredShDegree, the most that it can change a channel of any splat's colour,
   * in any direction.
   */
  readonly shBandReach: readonly number[];
  /** Entries of the palette of the harmonics before packing; null if each splat had its own. */
  readonly paletteEntries: number | null;
  /** Whether the three scales of each splat are equal, so that its rotation cannot be seen. */
  readonly isIsotropic: boolean;
  /** Whether the splats were trained with an antialias filter; null if the format does not say. */
  readonly isAntialiased: boolean | null;
  /** Null where the splats are of no file. */
  readonly fileFacts: FileFacts | null;
}

/**
 * A change of colour below this, a sixteenth of an 8-bit step, counts as invisible: blending in
 * float16 rounds a channel near white by as much, 2⁻¹², with each splat.
 *
 * A pixel changes by no more than its splats' colours do. It is Σ wᵢcᵢ plus its background. The
 * weights wᵢ ≥ 0 follow from shapes, opacities and order, not from colours, and sum to at most 1;
 * so |Σ wᵢΔcᵢ| ≤ max |Δcᵢ|. Each cᵢ is max(0, …) of the harmonics, which never enlarges a change.
 * Effects that brighten colours afterwards brighten the difference as well.
 */
export const UNSEEN_CHANGE = 1 / (16 * 255);

/**
 * Facts about `set`, whose rows must be finite. Takes a pass over the splats, and one over their
 * harmonics unless their reach is known already.
 *
 * @example
 * const { trueShDegree, isIsotropic } = cloudFacts(await readSplats('/garden.ply'));
 */
export function cloudFacts(set: SplatSet<Harmonics>): CloudFacts {
  const reach = shBandReach(givenSet(set).harmonics, set.count);
  return {
    declaredShDegree: set.harmonics.degree,
    trueShDegree: trueShDegree(reach),
    shBandReach: reach,
    paletteEntries: isPalette(set.harmonics) ? entryCountOf(set.harmonics) : null,
    isIsotropic: isIsotropic(set),
    isAntialiased: set.isAntialiased ?? null,
    fileFacts: set.fileFacts ?? null,
  };
}

/** Leaves out as many of the highest bands as stay unseen together. */
export function trueShDegree(reach: readonly number[]): ShDegree {
  let degree = reach.length;
  for (let change = 0; degree > 0; degree--) {
    change += reach[degree - 1];
    if (change >= UNSEEN_CHANGE) break;
  }
  return degree as ShDegree;
}

export function isIsotropic({ count, logScales }: Pick<SplatColumns, 'count' | 'logScales'>): boolean {
  for (let i = 0; i < 3 * count; i += 3) {
    if (logScales[i] !== logScales[i + 1] || logScales[i] !== logScales[i + 2]) return false;
  }
  return true;
}
