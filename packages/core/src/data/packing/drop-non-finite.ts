import { OPTIONAL_COLUMNS } from '../splats/columns.ts';
import { ROW_SLOT, reasonToDrop } from '../splats/splat-row.ts';
import { coefficientsPerSplat, type DropCounts, type SplatSet } from '../splats/splat-set.ts';
import { type Harmonics, readCoefficients } from './harmonics.ts';
import { permuteSplats } from './morton-order.ts';

/**
 * Drops the splats of `set` that are not finite and adds their number to `dropped`. Returns `set`
 * itself if there are none. Shaders assume that no value is NaN or infinite, so they rely on this.
 */
export function dropNonFinite<Kind extends Harmonics>(set: SplatSet<Kind>): SplatSet<Kind> {
  const kept = new Uint32Array(set.count);
  let keptCount = 0;
  const dropped: { -readonly [Reason in keyof DropCounts]: number } = { ...set.dropped };
  const row = new Float64Array(ROW_SLOT.harmonics + coefficientsPerSplat(set.harmonics.degree));
  for (let index = 0; index < set.count; index++) {
    fillRow(row, set, index);
    let reason = reasonToDrop(row);
    for (const { name, width, reasonToDrop: reasonOf } of OPTIONAL_COLUMNS)
      reason ??= set[name] && reasonOf(set[name].subarray(width * index, width * (index + 1)));
    if (reason === undefined) kept[keptCount++] = index;
    else dropped[reason] = (dropped[reason] ?? 0) + 1;
  }
  if (keptCount === set.count) return set;
  return { ...permuteSplats(set, kept.subarray(0, keptCount)), dropped };
}

function fillRow(row: Float64Array, set: SplatSet<Harmonics>, index: number): void {
  for (let axis = 0; axis < 3; axis++) {
    row[ROW_SLOT.position + axis] = set.positions[3 * index + axis];
    row[ROW_SLOT.logScale + axis] = set.logScales[3 * index + axis];
    row[ROW_SLOT.colorDc + axis] = set.colorDc[3 * index + axis];
  }
  for (let k = 0; k < 4; k++) row[ROW_SLOT.rotation + k] = set.rotations[4 * index + k];
  row[ROW_SLOT.opacity] = set.opacityLogits[index];
  readCoefficients(set.harmonics, index, row.subarray(ROW_SLOT.harmonics));
}
