import { MOTION_VALUES, reasonToDropMotion, stillMotion } from '../../features/motion/splat-motion.data.ts';
import { InvalidArgumentError } from '../errors.ts';

/**
 * The columns that a set may lack: name, values of each splat, the column of splats that look as if they had none, and
 * why a splat's values cannot be drawn. What checks, sorts, drops, joins or builds sets goes through this list.
 */
export const OPTIONAL_COLUMNS = [
  { name: 'motion', width: MOTION_VALUES, neutral: stillMotion, reasonToDrop: reasonToDropMotion },
] as const;

export type OptionalColumn = (typeof OPTIONAL_COLUMNS)[number];

/** All columns, and the values of each splat in them. */
export const COLUMNS = [
  ...(['positions', 'logScales', 'colorDc'] as const).map((name) => ({ name, width: 3 })),
  { name: 'rotations', width: 4 },
  { name: 'opacityLogits', width: 1 },
  { name: 'fileIndices', width: 1 },
  ...OPTIONAL_COLUMNS,
] as const;

type Columns = {
  readonly [Name in (typeof COLUMNS)[number]['name']]?: Float32Array | Float64Array | Uint32Array;
};

/** Makes another column of each that is there. @param change takes a column, and its values per splat. */
export function mapColumns<Given extends Columns>(
  columns: Given,
  change: <Column extends NonNullable<Columns[keyof Columns]>>(column: Column, width: number) => Column,
): Pick<Given, keyof Columns & keyof Given> {
  const changed = COLUMNS.flatMap(({ name, width }) => {
    const column = columns[name];
    return column ? [[name, change(column, width)]] : [];
  });
  return Object.fromEntries(changed);
}

/**
 * Refuses splats that move, where only splats that stand still can be handled.
 *
 * @param who subject of the message, such as `.spz`.
 * @throws InvalidArgumentError 'set'
 */
export function checkStill({ motion }: { readonly motion?: unknown }, who: string): void {
  if (!motion) return;
  const message = `These splats move, and ${who} holds only splats that stand still. Freeze them at a time, by splatsAt or convert --time, or write a PLY.`;
  throw new InvalidArgumentError('set', message);
}
