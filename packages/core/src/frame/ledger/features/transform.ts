import { linearPart } from '../../../data/math/mat4.ts';
import type { FeatureOfCloud } from '../automatic-feature.ts';

/** Lengths and angles that differ by less count as the same. */
const TOLERANCE = 1e-6;

/** A cloud's transform costs shaders nothing: it is part of one matrix, computed in float64. */
export const transform: FeatureOfCloud = {
  of: 'cloud',
  name: 'transform',
  label: 'Placement',
  about: 'Places a cloud in the world, on the CPU: shaders always take one matrix.',
  stages: [],
  calledFor: ({
    cloud: {
      instance: { modelMatrix, instances },
    },
  }) => (instances ? 'its instances have a place each' : modelMatrix ? describe(modelMatrix) : null),
  offReason: () => 'it stands where its file puts it',
};

/** Describes the effect of a matrix on a cloud; null for the identity. */
function describe(matrix: ArrayLike<number>): string | null {
  const m = linearPart(matrix);
  const dot = (a: number, b: number) =>
    m[3 * a] * m[3 * b] + m[3 * a + 1] * m[3 * b + 1] + m[3 * a + 2] * m[3 * b + 2];
  const square = dot(0, 0);
  const isSimilar = (a: number, b: number) => Math.abs(a - b) <= TOLERANCE * square;
  const isUniform =
    isSimilar(dot(1, 1), square) &&
    isSimilar(dot(2, 2), square) &&
    [dot(0, 1), dot(0, 2), dot(1, 2)].every((each) => isSimilar(each, 0));
  if (!isUniform) return 'it is stretched or sheared';
  if (Math.abs(square - 1) > TOLERANCE) return 'it is scaled alike in all directions';
  if (m.some((value, i) => value !== (i % 4 === 0 ? 1 : 0))) return 'it is turned, at its own size';
  return [matrix[12], matrix[13], matrix[14]].some((value) => value !== 0) ? 'it is moved' : null;
}
