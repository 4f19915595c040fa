import { InvalidArgumentError } from '@websplatter/core';
import { defineEffect, type EffectUse } from '@websplatter/core/effects';
import type { ClippingGroup, Object3D, Plane } from 'three/webgpu';

/** Planes of three's ClippingGroups in world space: the side behind their normals is cut off. */
interface ClippingPlanes {
  /** Each of them cuts off the space behind it. */
  readonly each: readonly Plane[];
  /** All of them together cut off the space behind all of them. */
  readonly together: readonly Plane[];
}

/** Planes of either kind that the effect has room for. */
const MOST_PLANES = 8;
/** Columns of a matrix without a plane: everything is before it, or behind it. */
const KEEPS_ALL = [0, 0, 0, 1];
const CUTS_ALL = [0, 0, 0, -1];

const wgsl = `
// Cuts off splats behind clipping planes, by their centres.
import package::lib::packing::Splat;
import parameters::ClippingGroups;

// A vector times a matrix is its products with the columns: the distances from four planes.
fn cutSplat(splat: Splat, splatIndex: u32, parameters: ClippingGroups) -> Splat {
  let point = vec4f(splat.position, 1.0);
  let isBeforeEach = all(point * parameters.each0 >= vec4f(0.0)) && all(point * parameters.each1 >= vec4f(0.0));
  let isBeforeAny = any(point * parameters.together0 >= vec4f(0.0)) || any(point * parameters.together1 >= vec4f(0.0));
  var cut = splat;
  cut.opacity *= f32(isBeforeEach && isBeforeAny);
  return cut;
}
`;

const MATRICES = { each0: 'mat4x4f', each1: 'mat4x4f', together0: 'mat4x4f', together1: 'mat4x4f' } as const;

const clippingGroups = defineEffect<ClippingPlanes, typeof MATRICES>({
  name: 'clipping-groups',
  label: 'Clipping groups',
  about: 'Cuts a cloud off at the planes of the ClippingGroups that it is in.',
  hooks: { splat: 'cutSplat' },
  wgsl,
  fields: MATRICES,
  calledFor: ({ each, together }) => {
    const count = each.length + together.length;
    return count === 0 ? null : `${count} clipping ${count === 1 ? 'plane cuts' : 'planes cut'} it off`;
  },
  check: ({ each, together }) => {
    for (const [kind, { length }] of [
      ['', each],
      [' whose clipIntersection is true', together],
    ] as const) {
      if (length <= MOST_PLANES) continue;
      const message = `A cloud is in ClippingGroups${kind} with ${length} planes in all; splats can be cut off by up to ${MOST_PLANES} of a kind.`;
      throw new InvalidArgumentError('clippingPlanes', message);
    }
  },
  valuesAt({ each, together }, { modelMatrix, origin }) {
    const columnsOf = (planes: readonly Plane[], rest: readonly number[]) => {
      const columns = planes.map((plane) => distancesFrom(plane, modelMatrix, origin));
      return Array.from({ length: MOST_PLANES }, (_, i) => columns[i] ?? rest).flat();
    };
    const all = [
      columnsOf(each, KEEPS_ALL),
      columnsOf(together, together.length === 0 ? KEEPS_ALL : CUTS_ALL),
    ];
    const [[each0, each1], [together0, together1]] = all.map((columns) => [
      columns.slice(0, 16),
      columns.slice(16),
    ]);
    return { each0, each1, together0, together1 };
  },
});

/**
 * Returns the effect that clips `object` as the ClippingGroups around it clip meshes; empty without
 * clipping planes.
 *
 * @throws InvalidArgumentError for more planes than the effect has room for.
 */
export function clippingOf(object: Object3D): EffectUse[] {
  const each: Plane[] = [];
  const together: Plane[] = [];
  for (let at: Object3D | null = object; at; at = at.parent) {
    const { isClippingGroup, enabled, clipIntersection, clippingPlanes } = at as Partial<ClippingGroup>;
    // Copied: the planes may change before the next frame is compared with this one.
    if (isClippingGroup && enabled) {
      const planes = clippingPlanes!.map((plane) => plane.clone());
      (clipIntersection ? together : each).push(...planes);
    }
  }
  return each.length + together.length === 0 ? [] : [clippingGroups({ each, together })];
}

/**
 * Returns factors of x, y, z and 1: distance of a cloud's point, relative to its origin, from a
 * plane of the world.
 */
function distancesFrom(
  { normal, constant }: Plane,
  m: ArrayLike<number>,
  [x, y, z]: readonly [number, number, number],
): number[] {
  const along = (column: number) =>
    normal.x * m[4 * column] + normal.y * m[4 * column + 1] + normal.z * m[4 * column + 2];
  const [byX, byY, byZ] = [along(0), along(1), along(2)];
  return [byX, byY, byZ, along(3) + byX * x + byY * y + byZ * z + constant];
}
