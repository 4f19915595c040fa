import fc from 'fast-check';
import {
  type Camera,
  cameraFromMatrices,
  orthographicCamera,
  perspectiveCamera,
} from '../data/camera/camera.ts';
import { multiply4 } from '../data/math/mat4.ts';
import { uniform } from './uniform.ts';

const coordinate = (limit: number) => uniform(-limit, limit);
const point = (limit: number) => fc.tuple(coordinate(limit), coordinate(limit), coordinate(limit));

/** Cameras around and inside the unit cube: narrow, wide, orthographic, off-centre, mirrored. */
export const anyCamera: fc.Arbitrary<Camera> = fc
  .record({
    position: point(3),
    target: point(1),
    fovYDegrees: uniform(1, 170),
    height: uniform(0.01, 10),
    aspect: uniform(0.2, 5),
    isOrthographic: fc.boolean(),
    isMirrored: fc.boolean(),
    shift: fc.oneof(fc.constant([0, 0]), fc.tuple(coordinate(1.5), coordinate(1.5))),
    near: fc.constantFrom(0.001, 0.1, 1),
    far: fc.constantFrom(4, 1000, Number.POSITIVE_INFINITY),
  })
  .filter(({ position, target }) => Math.hypot(position[0] - target[0], position[2] - target[2]) > 0.01)
  .map(({ isOrthographic, isMirrored, shift, near, far, ...options }) => {
    const camera = isOrthographic
      ? orthographicCamera({ ...options, near: near - 1, far })
      : perspectiveCamera({ ...options, near, far });
    const projection = Float64Array.from(camera.projectionMatrix);
    projection[isOrthographic ? 12 : 8] += shift[0];
    projection[isOrthographic ? 13 : 9] += shift[1];
    const mirror = Float64Array.of(isMirrored ? -1 : 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
    return cameraFromMatrices(camera.viewMatrix, multiply4(mirror, projection), camera);
  });

/** Arbitrary affine model matrices, mostly neither rigid nor uniform, some nearly flat or lines. */
export const anyModel: fc.Arbitrary<Float64Array> = fc
  .tuple(
    fc.array(coordinate(2), { minLength: 9, maxLength: 9 }),
    point(1),
    fc.constantFrom([1, 1], [1, 0.01], [0.01, 0.01]),
  )
  .map(([[a, b, c, d, e, f, g, h, i], [x, y, z], [p, q]]) =>
    Float64Array.of(a, b, c, 0, d * p, e * p, f * p, 0, g * q, h * q, i * q, 0, x, y, z, 1),
  );
