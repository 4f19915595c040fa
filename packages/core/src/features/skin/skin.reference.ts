import { transform3, type Vec3 } from '../../data/math/mat4.ts';
import { principalAxes } from '../../data/math/principal-axes.ts';
import { quaternionOfAxes } from '../../data/math/quaternion-of-axes.ts';
import type { PackedGeometry } from '../../data/packing/geometry.ts';
import { rotationMatrix } from '../../reference/covariance.ts';
import { type ReferenceSplat, unpackSplat } from '../../reference/packing.ts';

/**
 * Reference of skin-geometry, in float64: the moved splats, before they are packed. A splat's covariance
 * Σ becomes M Σ Mᵀ, whose principal axes are the moved splat's, the longest first.
 *
 * @param influences two words for each splat of `rest`: see `SplatSkin.words`.
 * @param joints three rows of four numbers of each joint's matrix, about the cloud's origin.
 */
export function skinGeometry(
  rest: PackedGeometry,
  influences: Uint32Array,
  joints: ArrayLike<number>,
  count: number,
): ReferenceSplat[] {
  return Array.from({ length: count }, (_, i) => {
    const rows = blendedRows(influences[2 * i], influences[2 * i + 1], joints);
    return skinSplat(unpackSplat(rest, i), rows);
  });
}

/** Mean of the matrices of four joints by their weights, in 255ths. */
function blendedRows(indices: number, weights: number, joints: ArrayLike<number>): number[] {
  const rows = new Array<number>(12).fill(0);
  for (let k = 0; k < 4; k++) {
    const joint = (indices >>> (8 * k)) & 255;
    const weight = ((weights >>> (8 * k)) & 255) / 255;
    for (let at = 0; at < 12; at++) rows[at] += weight * joints[12 * joint + at];
  }
  return rows;
}

function skinSplat(splat: ReferenceSplat, rows: readonly number[]): ReferenceSplat {
  const linear = [0, 1, 2].flatMap((column) => [rows[column], rows[4 + column], rows[8 + column]]);
  const translation = [rows[3], rows[7], rows[11]];
  const turn = rotationMatrix(...splat.rotation);
  const columns = splat.scale.map((scale, axis) =>
    transform3(
      linear,
      [0, 3, 6].map((row) => scale * turn[row + axis]),
    ),
  );
  const covariance = new Float64Array(9);
  for (let row = 0; row < 3; row++)
    for (let column = 0; column < 3; column++)
      for (const axis of columns) covariance[3 * row + column] += axis[row] * axis[column];
  const axes = principalAxes(covariance, 3);
  const scale = [0, 3, 6].map((at) =>
    Math.hypot(...columns.map((axis) => axis.reduce((sum, value, k) => sum + value * axes[at + k], 0))),
  );
  const position = transform3(linear, splat.position).map((value, axis) => value + translation[axis]);
  const rotation = quaternionOfAxes(axes);
  const length = Math.hypot(...rotation);
  return {
    ...splat,
    position: position as unknown as Vec3,
    scale: scale as unknown as Vec3,
    rotation: rotation.map((value) => value / length) as unknown as ReferenceSplat['rotation'],
  };
}
