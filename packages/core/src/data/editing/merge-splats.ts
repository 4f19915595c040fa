import { InvalidArgumentError } from '../errors.ts';
import { checkKind } from '../given.ts';
import type { Harmonics } from '../packing/harmonics.ts';
import { givenSet } from '../splats/check-set.ts';
import { OPTIONAL_COLUMNS } from '../splats/columns.ts';
import {
  addDrops,
  agreedAntialiasing,
  type DropCounts,
  type ShDegree,
  type SplatColumns,
  type SplatSet,
} from '../splats/splat-set.ts';
import { trainedCoefficients } from './limit-degree.ts';
import { placeSplats } from './place-splats.ts';

/**
 * All splats of several sets as one, set after set. Harmonics have the highest degree of them;
 * bands that a set lacks are 0. Positions are kept bit by bit where all sets have the same origin;
 * else they are taken relative to one that suits all.
 *
 * If any set has an optional column, such as `motion`, splats of the others get values that change nothing.
 *
 * Whether splats were trained with an antialias filter is kept where all sets say the same. The
 * result is of no file: its rows are numbered from 0.
 *
 * @throws InvalidArgumentError 'sets' if there are none; 'set' if one is too far away for float32.
 * @example
 * const house = await readSplats('/house.ply', { shPrecision: 'f32' });
 * const garden = await readSplats('/garden.ply', { shPrecision: 'f32' });
 * const bytes = await writeSplats(mergeSplats([house, garden]), 'spz');
 */
export function mergeSplats(sets: readonly SplatSet<Harmonics>[]): SplatSet<Harmonics> {
  checkKind('sets', sets, 'a list');
  for (const [i, set] of sets.entries()) givenSet(set, `sets[${i}]`);
  if (sets.length === 0) throw new InvalidArgumentError('sets', 'There are no splats to merge.');
  if (sets.length === 1) return sets[0];
  const count = sets.reduce((sum, set) => sum + set.count, 0);
  const degree = sets.reduce<ShDegree>(
    (most, { harmonics }) => Math.max(most, harmonics.degree) as ShDegree,
    0,
  );
  const column = (name: 'logScales' | 'rotations' | 'opacityLogits' | 'colorDc') =>
    joined(sets.map((set) => set[name]));
  const isAntialiased = agreedAntialiasing(sets);
  const dropped: DropCounts = {};
  for (const set of sets) addDrops(dropped, set.dropped);
  return {
    count,
    ...placed(sets),
    logScales: column('logScales'),
    rotations: column('rotations'),
    opacityLogits: column('opacityLogits'),
    colorDc: column('colorDc'),
    harmonics: { degree, coefficients: joined(sets.map((set) => trainedCoefficients(set, degree))) },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
    dropped,
    ...Object.fromEntries(
      OPTIONAL_COLUMNS.filter(({ name }) => sets.some((set) => set[name])).map(({ name, neutral }) => [
        name,
        joined(sets.map((set) => set[name] ?? neutral(set.count))),
      ]),
    ),
    ...(isAntialiased !== undefined && { isAntialiased }),
  };
}

function placed(sets: readonly SplatSet<Harmonics>[]): Pick<SplatColumns, 'origin' | 'positions'> {
  const { origin } = sets[0];
  if (sets.every((set) => set.origin.every((value, axis) => value === origin[axis])))
    return { origin, positions: joined(sets.map(({ positions }) => positions)) };
  const positions = new Float64Array(sets.reduce((sum, set) => sum + 3 * set.count, 0));
  let at = 0;
  for (const set of sets)
    for (let i = 0; i < 3 * set.count; i++) positions[at++] = set.positions[i] + set.origin[i % 3];
  return placeSplats(positions);
}

function joined(columns: readonly Float32Array[]): Float32Array {
  const result = new Float32Array(columns.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const column of columns) {
    result.set(column, at);
    at += column.length;
  }
  return result;
}
