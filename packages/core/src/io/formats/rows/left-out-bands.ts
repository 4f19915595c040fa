/** The highest degree of spherical harmonics that is drawn. */
const MOST_DEGREE = 3;

/** A note about harmonics above the readable degree; undefined if there are none. */
export function leftOutBands(fileDegree: number): string | undefined {
  if (fileDegree <= MOST_DEGREE) return undefined;
  const first = MOST_DEGREE + 1;
  return fileDegree === first
    ? `Its harmonics of degree ${first} are left out.`
    : `Its harmonics of degrees ${first} to ${fileDegree} are left out.`;
}
