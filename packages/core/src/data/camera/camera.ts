import { InvalidArgumentError } from '../errors.ts';
import { given, wrongArgument } from '../given.ts';
import { isFiniteF32 } from '../math/float-step.ts';
import { invert3, linearPart, type Mat4, transform3, type Vec3 } from '../math/mat4.ts';
import { cross, dot, plus } from '../math/vec3.ts';
import { shown } from '../printable.ts';

/**
 * A view of the world, in three.js's conventions: the camera looks along −z with y up, matrices are
 * column-major. A splat whose centre is not in near < depth ≤ far is not drawn.
 */
export interface Camera {
  /** World to view, rigid. */
  readonly viewMatrix: ArrayLike<number>;
  /** View to clip. Only x, y and w are used, so either depth convention works. */
  readonly projectionMatrix: ArrayLike<number>;
  /**
   * Projection of the whole image, if this camera shows a part of it, such as a tile of a large
   * picture: splats that reach into the part from outside then look as they do in the whole.
   * Default: `projectionMatrix`.
   */
  readonly wholeProjectionMatrix?: ArrayLike<number> | undefined;
  /** View depth up to which nothing is drawn, world units. */
  readonly near: number;
  /** View depth beyond which nothing is drawn, world units; Infinity allowed. */
  readonly far: number;
}

/** Where a camera stands and looks, in world units, and how much of depth it shows. */
export interface LookAtOptions {
  readonly position: Vec3;
  readonly target: Vec3;
  /** Default [0, 1, 0]; must not be parallel to the line of sight. */
  readonly up?: Vec3;
  /** Width of the image divided by its height. */
  readonly aspect: number;
  /** Default 0.01. */
  readonly near?: number;
  /** Default 1000. */
  readonly far?: number;
}

/**
 * Makes a perspective camera. `fovYDegrees` is the full vertical angle, 0…180 exclusive.
 *
 * @example
 * const camera = perspectiveCamera({ position: [0, 1, 3], target: [0, 0, 0], up: [0, 1, 0], aspect: 16 / 9, fovYDegrees: 50 });
 */
export function perspectiveCamera(options: LookAtOptions & { readonly fovYDegrees: number }): Camera {
  const { aspect, near = 0.01, far = 1000, fovYDegrees } = given(options);
  checkRange(aspect, near, far);
  if (!(Number.isFinite(fovYDegrees) && fovYDegrees > 0 && fovYDegrees < 180)) {
    throw new InvalidArgumentError(
      'fovYDegrees',
      `fovYDegrees is ${shown(fovYDegrees)}; it must lie between 0 and 180.`,
    );
  }
  if (!(near > 0)) {
    throw new InvalidArgumentError(
      'near',
      `near is ${near}; a perspective camera needs a near plane in front of it.`,
    );
  }
  const f = 1 / Math.tan((fovYDegrees * Math.PI) / 360);
  const projectionMatrix = new Float64Array(16);
  projectionMatrix[0] = f / aspect;
  projectionMatrix[5] = f;
  projectionMatrix[10] = far === Number.POSITIVE_INFINITY ? -1 : -(far + near) / (far - near);
  projectionMatrix[11] = -1;
  projectionMatrix[14] = far === Number.POSITIVE_INFINITY ? -2 * near : (-2 * far * near) / (far - near);
  return checked({ viewMatrix: lookAtMatrix(options), projectionMatrix, near, far });
}

/**
 * Makes an orthographic camera. `height` is the height of the image in world units.
 *
 * @example
 * const camera = orthographicCamera({ position: [0, 5, 0], target: [0, 0, 0], up: [0, 0, -1], aspect: 16 / 9, height: 4 });
 */
export function orthographicCamera(options: LookAtOptions & { readonly height: number }): Camera {
  const { aspect, near = 0.01, far = 1000, height } = given(options);
  checkRange(aspect, near, far);
  if (!(Number.isFinite(height) && height > 0)) {
    throw wrongArgument('height', height, 'a positive length in world units');
  }
  const projectionMatrix = new Float64Array(16);
  projectionMatrix[0] = 2 / (height * aspect);
  projectionMatrix[5] = 2 / height;
  projectionMatrix[10] = far === Number.POSITIVE_INFINITY ? 0 : -2 / (far - near);
  projectionMatrix[14] = far === Number.POSITIVE_INFINITY ? 0 : -(far + near) / (far - near);
  projectionMatrix[15] = 1;
  return checked({ viewMatrix: lookAtMatrix(options), projectionMatrix, near, far });
}

/**
 * Makes a camera from matrices. Without `near` and `far`, they are read from the projection matrix,
 * which must then have three.js's default clip depth (−1…1).
 *
 * @throws InvalidArgumentError if a matrix is not 16 finite numbers, or near and far make no range.
 * @example
 * const { matrixWorldInverse, projectionMatrix, near, far } = threeCamera;
 * const camera = cameraFromMatrices(matrixWorldInverse.elements, projectionMatrix.elements, { near, far });
 */
export function cameraFromMatrices(
  viewMatrix: ArrayLike<number>,
  projectionMatrix: ArrayLike<number>,
  range: { readonly near?: number; readonly far?: number } = {},
): Camera {
  checkMatrix('viewMatrix', viewMatrix);
  checkMatrix('projectionMatrix', projectionMatrix);
  const p = projectionMatrix;
  const isPerspective = p[11] !== 0;
  const { near: givenNear, far: givenFar } = given(range);
  checkDepths(givenNear ?? 0, givenFar ?? Number.POSITIVE_INFINITY);
  const near = givenNear ?? (isPerspective ? p[14] / (p[10] - 1) : (p[14] + 1) / p[10]);
  const far = givenFar ?? (isPerspective ? p[14] / (p[10] + 1) : (p[14] - 1) / p[10]);
  const farDepth = far < 0 || Number.isNaN(far) ? Number.POSITIVE_INFINITY : far;
  checkRange(1, near, farDepth);
  if (isPerspective && !(near > 0)) {
    throw new InvalidArgumentError(
      'near',
      `near is ${near}${givenNear === undefined ? ' by the projection matrix' : ''}; a perspective camera needs a near plane in front of it. Pass near and far if the matrix has another depth convention than −1…1.`,
    );
  }
  return checked({
    viewMatrix: Float64Array.from(viewMatrix),
    projectionMatrix: Float64Array.from(p),
    near,
    far: farDepth,
  });
}

/** Parts of a camera and image size that project splats; lengths in pixels, x right, y down. */
export interface Projection {
  readonly isOrthographic: boolean;
  readonly widthPx: number;
  readonly heightPx: number;
  /** Pixels per unit of x/depth and y/depth (perspective) or x and y (orthographic), y up. */
  readonly focalPx: readonly [number, number];
  /** Where the line of sight meets the image. */
  readonly centerPx: readonly [number, number];
  /** x/depth (orthographic: x) at the left and right edge of the image. */
  readonly edgesX: readonly [number, number];
  /** y/depth (orthographic: y) at the bottom and top edge of the image. */
  readonly edgesY: readonly [number, number];
  /** Range that x/depth is clamped to for the Jacobian. */
  readonly clampX: readonly [number, number];
  /** Range that y/depth is clamped to for the Jacobian. */
  readonly clampY: readonly [number, number];
  readonly near: number;
  readonly far: number;
}

/**
 * How far outside the whole image the Jacobian follows x/depth, as a fraction of its width. For a
 * centred view the clamp is at 1.3 times the tangent of half the field of view, as in the affine
 * approximation of the original implementation.
 */
const JACOBIAN_MARGIN = 0.15;

/** Returns the projection of `camera` for an image of `widthPx` × `heightPx`. */
export function projectionOf(camera: Camera, widthPx: number, heightPx: number): Projection {
  const { projectionMatrix, wholeProjectionMatrix = projectionMatrix, near, far } = camera;
  const [scaleX, shiftX, edgesX] = axisOf(projectionMatrix, 0);
  const [scaleY, shiftY, edgesY] = axisOf(projectionMatrix, 1);
  return {
    isOrthographic: projectionMatrix[11] === 0,
    widthPx,
    heightPx,
    focalPx: [(scaleX * widthPx) / 2, (scaleY * heightPx) / 2],
    centerPx: [((1 + shiftX) * widthPx) / 2, ((1 - shiftY) * heightPx) / 2],
    edgesX,
    edgesY,
    clampX: widened(axisOf(wholeProjectionMatrix, 0)[2]),
    clampY: widened(axisOf(wholeProjectionMatrix, 1)[2]),
    near,
    far,
  };
}

/**
 * Along x or y: scale and shift from tangent (orthographic: length) to ndc, and the tangents at ndc
 * −1 and 1.
 */
function axisOf(
  p: ArrayLike<number>,
  axis: 0 | 1,
): readonly [scale: number, shift: number, edges: readonly [number, number]] {
  // Perspective: w = depth, so ndc x = p0·x/depth − p8. Orthographic: ndc x = (p0·x + p12) / p15.
  const isOrthographic = p[11] === 0;
  const w = isOrthographic ? p[15] : -p[11];
  const scale = p[5 * axis] / w;
  const shift = isOrthographic ? p[12 + axis] / w : -p[8 + axis] / w;
  return [scale, shift, [(-1 - shift) / scale, (1 - shift) / scale]];
}

/** A line of sight in world space: its point at view depth d is origin + d·direction. */
export interface PixelRay {
  readonly origin: Vec3;
  /** Not normalised: its length corresponds to one unit of view depth. */
  readonly direction: Vec3;
}

/**
 * Returns the line of sight through a point of the image, px from its top left, x right and y down.
 *
 * @throws InvalidArgumentError if the view matrix is singular.
 */
export function pixelRay(
  { viewMatrix }: Camera,
  { isOrthographic, focalPx, centerPx }: Projection,
  [xPx, yPx]: readonly [number, number],
): PixelRay {
  const toWorld = invert3(linearPart(viewMatrix));
  if (!toWorld) {
    throw new InvalidArgumentError(
      'viewMatrix',
      'The view matrix is singular; it must be a rigid transform.',
    );
  }
  const x = (xPx - centerPx[0]) / focalPx[0];
  const y = (centerPx[1] - yPx) / focalPx[1];
  const [tx, ty, tz] = [viewMatrix[12], viewMatrix[13], viewMatrix[14]];
  return isOrthographic
    ? { origin: transform3(toWorld, [x - tx, y - ty, -tz]), direction: transform3(toWorld, [0, 0, -1]) }
    : { origin: transform3(toWorld, [-tx, -ty, -tz]), direction: transform3(toWorld, [x, y, -1]) };
}

/**
 * Position of the camera in the world.
 *
 * @example
 * const [x, y, z] = cameraPosition(camera.viewMatrix);
 */
export function cameraPosition(viewMatrix: ArrayLike<number>): [number, number, number] {
  const v = given(viewMatrix, {}, 'viewMatrix');
  // The inverse of a rigid rotation is its transpose.
  const transposed = [v[0], v[4], v[8], v[1], v[5], v[9], v[2], v[6], v[10]];
  const [x, y, z] = transform3(transposed, [v[12], v[13], v[14]]);
  return [-x, -y, -z];
}

function widened([low, high]: readonly [number, number]): [number, number] {
  const margin = JACOBIAN_MARGIN * (high - low);
  // A mirrored projection swaps its edges.
  return margin >= 0 ? [low - margin, high + margin] : [high + margin, low - margin];
}

/** @throws InvalidArgumentError if a matrix is more than float32 holds. */
function checked(camera: Camera): Camera {
  for (const name of ['viewMatrix', 'projectionMatrix'] as const) {
    if (Array.prototype.every.call(camera[name], isFiniteF32)) continue;
    throw new InvalidArgumentError(name, `The camera's ${name} exceeds float32.`);
  }
  return camera;
}

function lookAtMatrix({ position, target, up = [0, 1, 0] }: LookAtOptions): Mat4 {
  for (const [name, place] of Object.entries({ position, target, up })) {
    if (place?.length === 3 && Array.prototype.every.call(place, Number.isFinite)) continue;
    throw wrongArgument(name, place, 'three finite numbers');
  }
  const back = normalized(plus(position, target, -1));
  const right = back && normalized(cross(up, back));
  if (!back || !right) {
    const what = back ? 'up is parallel to the line of sight' : 'position and target are the same point';
    throw new InvalidArgumentError('target', `The camera has no direction: ${what}.`);
  }
  const above = cross(back, right);
  return Float64Array.of(
    right[0],
    above[0],
    back[0],
    0,
    right[1],
    above[1],
    back[1],
    0,
    right[2],
    above[2],
    back[2],
    0,
    -dot(right, position),
    -dot(above, position),
    -dot(back, position),
    1,
  );
}

/** @throws InvalidArgumentError unless `matrix` is 16 finite numbers. */
export function checkMatrix(name: string, matrix: ArrayLike<number> | undefined, owner?: string): void {
  if (matrix?.length === 16 && Array.prototype.every.call(matrix, Number.isFinite)) return;
  throw wrongArgument(name, matrix, '16 finite numbers, column-major', owner);
}

function checkRange(aspect: number, near: number, far: number): void {
  if (!(Number.isFinite(aspect) && aspect > 0)) {
    throw wrongArgument('aspect', aspect, 'width divided by height');
  }
  checkDepths(near, far);
}

/** @throws InvalidArgumentError unless near is finite and far is greater. */
export function checkDepths(near: number, far: number): void {
  if (!isFiniteF32(near) || typeof far !== 'number' || !(far > near)) {
    throw new InvalidArgumentError(
      'far',
      `near is ${shown(near)} and far is ${shown(far)}; far must be greater.`,
    );
  }
}

function normalized(v: Vec3): Vec3 | null {
  const length = Math.hypot(v[0], v[1], v[2]);
  // Parallel vectors do not give exactly zero: rounding leaves about 1e-16.
  return length > 1e-12 ? [v[0] / length, v[1] / length, v[2] / length] : null;
}
