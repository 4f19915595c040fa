import { SplatFileError } from '../../../data/errors.ts';
import { MOTION_SLOT } from '../../../features/motion/splat-motion.data.ts';
import type { PlyElement, PlyHeader } from './ply-header.ts';

/** Properties of Spacetime Gaussians by the first of their slots; each group is complete or absent. */
const GROUPS: readonly (readonly [slot: number, names: readonly string[]])[] = [
  [MOTION_SLOT.time, ['trbf_center', 'trbf_scale']],
  [MOTION_SLOT.velocity, ['motion_0', 'motion_1', 'motion_2']],
  [MOTION_SLOT.acceleration, ['motion_3', 'motion_4', 'motion_5']],
  [MOTION_SLOT.jerk, ['motion_6', 'motion_7', 'motion_8']],
  [MOTION_SLOT.turn, ['omega_0', 'omega_1', 'omega_2', 'omega_3']],
];

/** Names of all properties of a motion, in the order of `MOTION_SLOT`. */
export const MOTION_PROPERTIES: readonly string[] = GROUPS.flatMap(([, names]) => names);

/**
 * Finds the motion of an element's splats: properties with their slots in `MOTION_SLOT`; none if the
 * splats stand still. Polynomials may end before the third power, splats may have no time or no turn.
 *
 * @throws SplatFileError 'bad-property' if a group of properties is incomplete.
 */
export function motionPropertiesOf(
  { name: element, properties }: PlyElement,
  file: string,
): readonly (readonly [name: string, slot: number])[] {
  const names = new Set(properties.map(({ name }) => name));
  return GROUPS.flatMap(([slot, group]) => {
    const missing = group.filter((name) => !names.has(name));
    if (missing.length === group.length) return [];
    if (missing.length > 0) {
      const found = group.filter((name) => names.has(name)).join(', ');
      const message = `it has ${found} without ${missing.join(', ')}, which a moving scene needs together. Export it again.`;
      throw new SplatFileError('bad-property', file, message, { element, property: missing[0] });
    }
    return group.map((name, i) => [name, slot + i] as const);
  });
}

/** A comment of moving files whose f_dc are harmonics, without which they would be read as colours. */
export const HARMONICS_COMMENT = 'f_dc: spherical harmonics';

/**
 * Whether f_dc are red, green and blue from 0 to 1, as the lite trainer of Spacetime Gaussians saves
 * them. Exporters that have harmonics write f_rest, or a comment.
 *
 * @throws SplatFileError 'not-splats' for the full model, whose f_dc and f_t are features for a network.
 */
export function hasPlainColors(
  { name: element, properties }: PlyElement,
  { namesHarmonics }: PlyHeader,
  file: string,
): boolean {
  const found = (pattern: RegExp) => properties.find(({ name }) => pattern.test(name))?.name;
  const property = found(/^f_(dc_([3-9]|\d\d)|t_\d)/);
  if (property) {
    const message = `a network in another file makes its colours of ${property}. Export the lite model of Spacetime Gaussians.`;
    throw new SplatFileError('not-splats', file, message, { element, property });
  }
  return !(namesHarmonics || !found(/^trbf_/) || found(/^f_rest_/) || !found(/^f_dc_/));
}
