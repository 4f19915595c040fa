/** PSNR of a cut: of a picture with at most this share of the splats in sight. */
export interface CutPoint {
  /** 0…1. */
  readonly share: number;
  /** Against the full picture; Infinity for equal images. */
  readonly psnrDb: number;
}

/** More of the splats take as long in blobs as all of them without. */
export const MOST_SHARE = 0.7;

/**
 * PSNR of cuts of scenes that were never measured: antialiased, from one to eight times the
 * distance, of an object and of grass, within 4 dB.
 */
const TYPICAL: readonly CutPoint[] = [
  { share: 0.06, psnrDb: 27 },
  { share: 0.12, psnrDb: 29 },
  { share: 0.25, psnrDb: 32 },
  { share: 0.5, psnrDb: 38 },
];
/** Half of the splats cost between these, beside the points that are known. */
const LEAST_SLOPE_DB = 2;
const MOST_SLOPE_DB = 10;

/**
 * Predicts the PSNR, in dB, of a cut that draws `share` of the splats in sight, from measured cuts of
 * any distance. PSNR depends far more on the share than on the number of splats in sight.
 */
export function predictPsnrDb(measured: readonly CutPoint[], share: number): number {
  const { at, slopeDb } = nearest(measured, (point) => Math.abs(Math.log2(share / point.share)));
  return at.psnrDb + slopeDb * Math.log2(share / at.share);
}

/** Predicts the share of the splats in sight with which a picture reaches `psnrDb`. */
export function predictShare(measured: readonly CutPoint[], psnrDb: number): number {
  const { at, slopeDb } = nearest(measured, (point) => Math.abs(psnrDb - point.psnrDb));
  return at.share * 2 ** ((psnrDb - at.psnrDb) / slopeDb);
}

/** Returns the nearest point, and by how much PSNR falls there with half of the splats. */
function nearest(measured: readonly CutPoint[], distanceTo: (point: CutPoint) => number) {
  const known = measured.filter(({ psnrDb }) => Number.isFinite(psnrDb));
  const [at, other] = (known.length > 0 ? known : TYPICAL).toSorted((a, b) => distanceTo(a) - distanceTo(b));
  const typical = TYPICAL.toSorted((a, b) => Math.abs(a.psnrDb - at.psnrDb) - Math.abs(b.psnrDb - at.psnrDb));
  const [from, to] = other ? [at, other] : typical;
  const slopeDb = (to.psnrDb - from.psnrDb) / Math.log2(to.share / from.share);
  return { at, slopeDb: Math.min(Math.max(slopeDb, LEAST_SLOPE_DB), MOST_SLOPE_DB) };
}
