import { unpackShRest } from '../layout/sh-rest.ts';
import { type CloudView, FALLBACK_DIRECTION } from '../scene/cloud-view.ts';
import { SH_REST_COEFFICIENTS, type ShDegree, type SplatSet } from '../scene/splat-set.ts';
import { shColor } from './spherical-harmonics.ts';

/** Unit vector, in cloud space, along which the camera sees splat `index`. */
function viewDirection(set: SplatSet, index: number, view: CloudView): [number, number, number] {
  const toward = view.camera
    ? [0, 1, 2].map((axis) => set.positions[3 * index + axis] - view.camera![axis])
    : view.direction;
  const length = Math.hypot(toward[0], toward[1], toward[2]);
  if (!(length > 0)) return [...FALLBACK_DIRECTION];
  return [toward[0] / length, toward[1] / length, toward[2] / length];
}

const rest = new Float64Array(3 * SH_REST_COEFFICIENTS[3]);

/** Twin of the GPU's project, its colour part: r, g, b of splat `index` as the camera sees it. */
export function splatColor(
  set: SplatSet,
  index: number,
  view: CloudView,
  degreeLimit: ShDegree,
): [number, number, number] {
  const degree = Math.min(set.shRest.degree, degreeLimit) as ShDegree;
  unpackShRest(set.shRest, index, rest);
  const dc = set.colorDc.subarray(3 * index, 3 * index + 3);
  return shColor(degree, dc, rest, viewDirection(set, index, view));
}
