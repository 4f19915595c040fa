/** PSNR of a cut: of a picture with at most this share of the splats in sight. */
export interface CutPoint {
  /** 0…1. */
  readonly share: number;
  /** Against the full picture; Infinity for equal images. */
  readonly psnrDb: number;
}

/** More of the splats take as long in blobs as all of them without. */
export const MOST_SHARE = 0.7;
/** The first cut of a scene of which none is known. */
const FIRST_SHARE = 1 / 8;

/** Half of the splats cost this if only one cut is known, as they do in the middle of 200 views of four scenes. */
const TYPICAL_SLOPE_DB = 4;
/** Half of the splats cost between these. */
const LEAST_SLOPE_DB = 2;
const MOST_SLOPE_DB = 30;
/** Stands for equal pictures: their PSNR is infinite. */
const MOST_PSNR_DB = 90;

/**
 * Predicts the PSNR, in dB, of a cut that draws `share` of the splats in sight, from cuts that are
 * known from about the same camera; null if none is.
 */
export function predictPsnrDb(known: readonly CutPoint[], share: number): number | null {
  const found = nearest(known, (cut) => Math.log2(cut.share / share));
  return found && found.at.psnrDb + found.slopeDb * Math.log2(share / found.at.share);
}

/** Predicts the share of the splats in sight with which a picture reaches `psnrDb`. */
export function predictShare(known: readonly CutPoint[], psnrDb: number): number {
  const found = nearest(known, (cut) => cut.psnrDb - psnrDb);
  if (!found) return FIRST_SHARE;
  const { at, slopeDb } = found;
  return at.share * 2 ** ((psnrDb - at.psnrDb) / slopeDb);
}

/**
 * Predicts a share as `predictShare` does, but none below all known cuts, for cuts that were not
 * measured: levels of small clouds end abruptly.
 */
export function predictCertainShare(known: readonly CutPoint[], psnrDb: number): number {
  return Math.max(predictShare(known, psnrDb), Math.min(...known.map(({ share }) => share)));
}

/** Returns the nearest cut, and by how much PSNR falls there with half of the splats. */
function nearest(known: readonly CutPoint[], differenceOf: (cut: CutPoint) => number) {
  // If no splat is in sight, all pictures are equal.
  if (!known.some(({ psnrDb }) => Number.isFinite(psnrDb))) return null;
  const cuts = known.map(({ share, psnrDb }) => ({ share, psnrDb: Math.min(psnrDb, MOST_PSNR_DB) }));
  const [at, ...others] = cuts.toSorted((a, b) => Math.abs(differenceOf(a)) - Math.abs(differenceOf(b)));
  // The next one on the other side, if there is one: between two cuts, predictions are better than beyond.
  const other = others.find((cut) => differenceOf(cut) * differenceOf(at) < 0) ?? others[0];
  const slopeDb = other ? (other.psnrDb - at.psnrDb) / Math.log2(other.share / at.share) : TYPICAL_SLOPE_DB;
  return { at, slopeDb: Math.min(Math.max(slopeDb, LEAST_SLOPE_DB), MOST_SLOPE_DB) };
}
