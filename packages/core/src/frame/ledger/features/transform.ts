import { linearPart, scalesEvenly } from '../../../data/math/mat4.ts';
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
  if (!scalesEvenly(m, TOLERANCE)) return 'it is stretched or sheared';
  const square = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
  if (Math.abs(square - 1) > TOLERANCE) return 'it is scaled alike in all directions';
  if (m.some((value, i) => value !== (i % 4 === 0 ? 1 : 0))) return 'it is turned, at its own size';
  return [matrix[12], matrix[13], matrix[14]].some((value) => value !== 0) ? 'it is moved' : null;
}
