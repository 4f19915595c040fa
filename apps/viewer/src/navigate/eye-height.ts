import type { LengthScale, LengthUnit } from '../state/inspecting.ts';
import type { Vec3 } from '../state/vec3.ts';
import { EYES_M } from './walker.ts';

const METRES: Readonly<Record<LengthUnit, number>> = {
  mm: 1e-3,
  cm: 1e-2,
  m: 1,
  km: 1e3,
  in: 0.0254,
  ft: 0.3048,
};
/** Rooms are higher than the eyes. */
const MOST_HEIGHTS = 0.65;
/** What is flat is wider than a dozen heights. */
const MOST_WIDTHS = 1 / 12;
/** Few captures are wider than 240 metres; in wider ones, steps are lost in the mesh's cells. */
const LEAST_WIDTHS = 1 / 150;

/**
 * Height of a person's eyes in scene units. Where no known length has been set, units are taken for
 * metres, as phones and surveys write them, unless a person would then be too high for a scene of
 * this size, or lost in it: training from pictures alone knows no units.
 *
 * @param size of the scene: its width, height and depth.
 */
export function guessedEyeHeight([width, height, depth]: Vec3, known: LengthScale | null): number {
  if (known) return EYES_M / (known.perSceneUnit * METRES[known.unit]);
  const widest = Math.max(width, depth);
  const most = Math.max(MOST_HEIGHTS * height, MOST_WIDTHS * widest) || EYES_M;
  return Math.min(Math.max(EYES_M, LEAST_WIDTHS * widest), most);
}
