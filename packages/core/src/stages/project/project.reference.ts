import { type CloudView, FALLBACK_DIRECTION } from '../../data/camera/cloud-view.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { transform3, type Vec3 } from '../../data/math/mat4.ts';
import { type Harmonics, readCoefficients } from '../../data/packing/harmonics.ts';
import { shRestBasis } from '../../data/splats/spherical-harmonics.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../../data/splats/splat-set.ts';
import type { EffectReference } from '../../reference/effects/effect-reference.ts';
import type { CulledSplat, PageSlots } from '../cull/cull.reference.ts';

const C0 = Math.sqrt(1 / (4 * Math.PI));

/**
 * Evaluates the colour seen along the unit vector `direction`, from the camera to the splat, in the
 * cloud's space.
 *
 * @param dc three coefficients of degree 0.
 * @param rest 3K coefficients above degree 0, each as r, g, b.
 * @returns r, g, b in the space the scene was trained in (sRGB-encoded), which may be below 0 and
 *   above 1.
 */
export function shColor(
  degree: ShDegree,
  dc: ArrayLike<number>,
  rest: ArrayLike<number>,
  direction: readonly [number, number, number],
): [number, number, number] {
  const basis = shRestBasis(degree, ...direction);
  const color: [number, number, number] = [0, 0, 0];
  for (let channel = 0; channel < 3; channel++) {
    let sum = 0.5 + C0 * dc[channel];
    for (let k = 0; k < basis.length; k++) sum += basis[k] * rest[3 * k + channel];
    color[channel] = sum;
  }
  return color;
}

/** Unit vector along which the harmonics of a splat at `position` are evaluated: see `cloudView`. */
function viewDirection(position: Vec3, { camera, sight, direction }: CloudView): [number, number, number] {
  const toward = camera
    ? transform3(
        sight,
        position.map((value, axis) => value - camera[axis]),
      )
    : direction;
  const length = Math.hypot(toward[0], toward[1], toward[2]);
  if (!(length > 0)) return [...FALLBACK_DIRECTION];
  return [toward[0] / length, toward[1] / length, toward[2] / length];
}

const rest = new Float64Array(coefficientsPerSplat(3));

/**
 * Reference of project's colours: r, g, b of splat `index` in storage order, seen from the camera.
 *
 * @param row where `set` holds it; default `index`.
 */
export function splatColor(
  set: SplatSet<Harmonics>,
  index: number,
  view: CloudView,
  degreeLimit: ShDegree,
  { splat, centerView }: Pick<CulledSplat, 'splat' | 'centerView'>,
  effects: readonly EffectReference[] = [],
  row = index,
): Vec3 {
  const degree = Math.min(set.harmonics.degree, degreeLimit) as ShDegree;
  readCoefficients(set.harmonics, row, rest);
  const dc = set.colorDc.subarray(3 * row, 3 * row + 3);
  let color: Vec3 = shColor(degree, dc, rest, viewDirection(splat.position, view));
  for (const { changeColor } of effects) color = changeColor?.(color, splat, index, centerView) ?? color;
  // A negative radiance has no meaning, and would darken the splats behind it.
  return [Math.max(0, color[0]), Math.max(0, color[1]), Math.max(0, color[2])];
}

/**
 * Reference of plan-project: distributes the visible splats over the pages.
 *
 * @param splatCounts number of visible splats of each visible chunk.
 * @param visibleCapacity most splats to distribute; the last ones are left out.
 * @returns the range of each page among all visible splats, their number in total, and the number
 *   of workgroups that project each page.
 */
export function planProject(
  splatCounts: ArrayLike<number>,
  pages: readonly PageSlots[],
  visibleCapacity: number,
) {
  const splatsBefore = (slot: number) =>
    Math.min(
      visibleCapacity,
      Array.from(splatCounts)
        .slice(0, slot)
        .reduce((sum, count) => sum + count, 0),
    );
  const splats = pages.map(({ slotStart, slotCount }) => ({
    visibleStart: splatsBefore(slotStart),
    visibleCount: splatsBefore(slotStart + slotCount) - splatsBefore(slotStart),
  }));
  return {
    splats,
    visibleCount: splatsBefore(splatCounts.length),
    workgroups: splats.map(({ visibleCount }) =>
      Math.ceil(visibleCount / SHADER_CONSTANTS.PROJECT_WORKGROUP),
    ),
  };
}
