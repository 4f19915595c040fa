import { colorDcOf, logitOf } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import type { SplatColumns } from '../../../data/splats/splat-set.ts';
import type { PlyElement, PlyHeader, PlyType } from '../ply/ply-header.ts';
import { type PlyVariant, readPlyWith } from '../ply/read-ply.ts';
import type { ReadFormat } from '../read-format.ts';

const CHANNELS = ['red', 'green', 'blue'];
const COLORS = ['f_dc_0', 'f_dc_1', 'f_dc_2'];
const SHAPE = ['scale_0', 'scale_1', 'scale_2', 'rot_0', 'rot_1', 'rot_2', 'rot_3'];

/** Value of full colour or opacity, by type. */
const MAX_OF_TYPE: Partial<Record<PlyType, number>> = { uint8: 255, uint16: 65535, float32: 1, float64: 1 };

/**
 * Reads a PLY with `red`, `green` and `blue` instead of f_dc. It holds splats (nerfstudio's export
 * with colours), or points, which have neither scales nor rotations. Points become round splats of
 * one size, opaque unless they have `alpha`.
 *
 * Everything else is as in PLY. Meshes are refused.
 */
export const read: ReadFormat = (input, options) => readPlyWith(input, options, undefined, variantOf);

/** Substitutes for missing properties; undefined if the file cannot be read. */
function variantOf(
  { elements }: PlyHeader,
  { properties }: PlyElement,
  missing: readonly string[],
): PlyVariant | undefined {
  const slotOf = new Map<string, number>();
  /** Value of full colour or opacity, by slot. */
  const maxOf = new Map<number, number>();
  const takeInstead = (name: string, slot: number) => {
    const type = properties.find((property) => property.name === name)?.type;
    const max = type && MAX_OF_TYPE[type];
    if (max === undefined) return false;
    slotOf.set(name, slot);
    maxOf.set(slot, max);
    return true;
  };
  const lacksAll = (names: readonly string[]) => names.every((name) => missing.includes(name));
  const hasFaces = elements.some(({ name, count }) => /^(face|tristrips)$/.test(name) && count > 0);
  if (!lacksAll(COLORS) || !CHANNELS.every((name, i) => takeInstead(name, ROW_SLOT.colorDc + i)))
    return undefined;
  const isPoints = lacksAll(SHAPE) && !hasFaces;
  const replaced = isPoints ? [...COLORS, ...SHAPE, 'opacity'] : COLORS;
  if (!missing.every((name) => replaced.includes(name))) return undefined;
  if (missing.includes('opacity')) takeInstead('alpha', ROW_SLOT.opacity);
  return {
    slotOf,
    defaults: [
      [ROW_SLOT.rotation, 1],
      [ROW_SLOT.opacity, Number.POSITIVE_INFINITY],
    ],
    note: isPoints
      ? 'Its points are shown as round splats, as large as their number and their bounds suggest.'
      : undefined,
    complete: (set) => complete(set, maxOf, isPoints),
  };
}

/** Converts the substitutes to the missing properties. */
function complete(
  { count, positions, logScales, colorDc, opacityLogits }: SplatColumns,
  maxOf: ReadonlyMap<number, number>,
  isPoints: boolean,
): void {
  for (let i = 0; i < colorDc.length; i++)
    colorDc[i] = colorDcOf(colorDc[i] / maxOf.get(ROW_SLOT.colorDc + (i % 3))!);
  const maxAlpha = maxOf.get(ROW_SLOT.opacity);
  if (maxAlpha !== undefined) {
    for (let i = 0; i < count; i++)
      opacityLogits[i] = logitOf(Math.max(0, Math.min(1, opacityLogits[i] / maxAlpha)));
  }
  if (isPoints) logScales.fill(pointLogScale(positions, count));
}

/**
 * Log of half the point spacing, if all points lay on a square whose side is the diagonal of their
 * bounding box. Scans are surfaces, not volumes.
 */
function pointLogScale(positions: Float32Array, count: number): number {
  const [x, y, z] = [0, 1, 2].map((axis) => {
    let [min, max] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
    for (let i = axis; i < positions.length; i += 3) {
      min = Math.min(min, positions[i]);
      max = Math.max(max, positions[i]);
    }
    return max - min;
  });
  return Math.log((Math.hypot(x, y, z) || 1) / Math.sqrt(count) / 2);
}
