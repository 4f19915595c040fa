import { wrongArgument } from '../data/given.ts';
import { linearPart, transform3, type Vec3 } from '../data/math/mat4.ts';
import { checkOneOf } from '../data/packing/check-precision.ts';
import type { CloudFacts } from '../data/packing/cloud-facts.ts';
import { fileUp, USUAL_UP } from '../data/packing/file-up.ts';
import { checkVector, isFiniteF32 } from '../gpu/effects/option-checks.ts';
import type { FramingWishes, SceneKind } from './scene-framing.ts';

/** Options for the first camera of a scene. */
export interface FramingOptions {
  /** Width of the image over its height. Default: 1.6. */
  readonly aspect?: number;
  /** Vertical field of view in degrees, above 0 and below 180. Default: 50. */
  readonly fovYDegrees?: number;
  /**
   * Up direction in the world, of any length above 0, if the application defines it. Default: up as
   * the file format defines it (glTF), else estimated from floors and walls.
   */
  readonly up?: Vec3;
  /** How to look at the scene. Default: detected from its splats. */
  readonly kind?: SceneKind;
}

const KINDS: readonly SceneKind[] = ['object', 'surrounded', 'enclosed'];

/** @throws InvalidArgumentError naming the option. */
export function checkFramingOptions({ aspect = 1, fovYDegrees = 50, up, kind }: FramingOptions): void {
  if (!(isFiniteF32(aspect) && aspect > 0))
    throw wrongArgument('aspect', aspect, 'the width of the image over its height');
  if (!(typeof fovYDegrees === 'number' && fovYDegrees > 0 && fovYDegrees < 180))
    throw wrongArgument('fovYDegrees', fovYDegrees, 'an angle above 0° and below 180°');
  if (up !== undefined) checkVector('up', up, 'a direction in the world', { isDirection: true });
  checkOneOf('kind', kind, KINDS);
}

/**
 * The facts of one file's splats, and their model matrix to world space: 16 numbers, column-major.
 */
export interface FramedCloud {
  readonly facts: Pick<CloudFacts, 'fileFacts'>;
  readonly matrix: ArrayLike<number>;
}

/** The wishes of checked options; `parts` has at least one entry. */
export function framingWishes(parts: readonly FramedCloud[], options: FramingOptions): FramingWishes {
  const { aspect = 1.6, fovYDegrees = 50, kind = null, up } = options;
  return { aspect, fovYDegrees, kind, ...upOf(parts, up) };
}

/** The defined up direction, null if it must be estimated, and the usual one. */
function upOf(parts: readonly FramedCloud[], up: Vec3 | undefined): Pick<FramingWishes, 'up' | 'usualUp'> {
  const inWorld = ({ facts, matrix }: FramedCloud) => turned(fileUp(facts) ?? USUAL_UP, linearPart(matrix));
  const isDefined = parts.every(({ facts }) => fileUp(facts) !== null);
  const usualUp = inWorld(parts[0]);
  if (up) return { up: unit([up[0], up[1], up[2]]) ?? usualUp, usualUp };
  return { up: isDefined ? usualUp : null, usualUp };
}

/** The direction transformed to world space; unchanged if the matrix collapses it. */
function turned(direction: Vec3, matrix: readonly number[]): Vec3 {
  return unit(transform3(matrix, direction)) ?? direction;
}

/** The unit vector; null for a vector of length 0. */
function unit(vector: Vec3): Vec3 | null {
  // Scaled first, so that squares neither overflow nor underflow.
  const largest = Math.max(...vector.map(Math.abs));
  if (!(largest > 0 && Number.isFinite(largest))) return null;
  const [x, y, z] = vector.map((value) => value / largest);
  const length = Math.sqrt(x * x + y * y + z * z);
  return [x / length, y / length, z / length];
}
