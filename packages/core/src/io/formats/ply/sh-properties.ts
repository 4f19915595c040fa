import { SplatFileError } from '../../../data/errors.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../../../data/splats/splat-set.ts';
import { leftOutBands } from '../left-out-bands.ts';
import type { PlyElement } from './ply-header.ts';

/** Properties of an element with spherical harmonics above degree 0. */
export interface ShProperties {
  /** Highest degree that is read. */
  readonly degree: ShDegree;
  /** Names up to `degree`, in the order of `ROW_SLOT`; files have red, then green, then blue. */
  readonly names: readonly string[];
  /** See `FileFacts`; undefined if all coefficients are read. */
  readonly note: string | undefined;
}

/**
 * Finds the harmonics of an element by its number of `f_rest` properties. Bands above degree 3,
 * which some trainers write, are ignored.
 *
 * @throws SplatFileError 'bad-property' if the number matches no degree.
 */
export function shPropertiesOf({ name, properties }: PlyElement, file: string): ShProperties {
  const count = properties.filter((property) => /^f_rest_\d+$/.test(property.name)).length;
  const fileDegree = Math.sqrt(count / 3 + 1) - 1;
  if (!Number.isInteger(fileDegree)) {
    throw new SplatFileError(
      'bad-property',
      file,
      `there are ${count} f_rest properties; spherical harmonics of degree 0, 1, 2, 3 or 4 have 0, 9, 24, 45 or 72. Export it again.`,
      { element: name },
    );
  }
  const degree = Math.min(3, fileDegree) as ShDegree;
  const perChannel = count / 3;
  const names = Array.from(
    { length: 3 * SH_REST_COEFFICIENTS[degree] },
    (_, i) => `f_rest_${(i % 3) * perChannel + Math.floor(i / 3)}`,
  );
  return { degree, names, note: leftOutBands(fileDegree) };
}
