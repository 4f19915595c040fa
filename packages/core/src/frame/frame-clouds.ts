import { framePlaced } from '../clouds/framing/frame-placed.ts';
import type { PlacedCloud } from '../clouds/framing/read-samples.ts';
import { checkMatrix } from '../data/camera/camera.ts';
import type { FramingWishes, SceneFraming, SceneKind } from '../data/framing/scene-framing.ts';
import { CLOUD, checkKind, given, wrongArgument } from '../data/given.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import { linearPart, transform3 } from '../data/math/mat4.ts';
import { checkOneOf } from '../data/packing/check-precision.ts';
import { fileUp, USUAL_UP } from '../data/packing/file-up.ts';
import { checkVector, isFiniteF32 } from '../gpu/effects/option-checks.ts';
import { checkInstances, worldMatrices } from './cloud-instances.ts';
import type { CloudInstance } from './frame-request.ts';

/** Options of `frameScene`. */
export interface FrameSceneOptions {
  /** Width of the image over its height. Default: 1.6. */
  readonly aspect?: number;
  /** Vertical field of view in degrees, above 0 and below 180. Default: 50. */
  readonly fovYDegrees?: number;
  /**
   * Up in the world, of any length above 0, if the application knows it. Default: up as the format
   * of the files defines it (glTF); else as floors and walls tell it.
   */
  readonly up?: Vec3;
  /** How to look at the scene. Default: what is found. */
  readonly kind?: SceneKind;
  /** Calls the work off. */
  readonly signal?: AbortSignal;
}

const KINDS: readonly SceneKind[] = ['object', 'surrounded', 'enclosed'];

/** See `frameScene`. */
export async function frameClouds(
  clouds: readonly CloudInstance[],
  options: FrameSceneOptions,
): Promise<SceneFraming | null> {
  const plan = planFraming(clouds, options);
  options.signal?.throwIfAborted();
  return plan && framePlaced(plan.placed, plan.wishes, options.signal);
}

/**
 * Returns what is to be framed, and how; null if no cloud is drawn.
 *
 * @throws InvalidArgumentError naming the argument, DestroyedError, GpuLimitError.
 */
export function planFraming(
  clouds: readonly CloudInstance[],
  options: FrameSceneOptions,
): { readonly placed: readonly PlacedCloud[]; readonly wishes: FramingWishes } | null {
  checkFraming(clouds, given(options));
  const { aspect = 1.6, fovYDegrees = 50, kind = null, up } = options;
  const placed = clouds.map(placedCloud).filter(({ opacities }) => opacities.some((opacity) => opacity > 0));
  return placed.length > 0 ? { placed, wishes: { aspect, fovYDegrees, kind, ...upOf(placed, up) } } : null;
}

function checkFraming(
  clouds: readonly CloudInstance[],
  { aspect = 1, fovYDegrees = 50, up, kind }: FrameSceneOptions,
): void {
  if (!(isFiniteF32(aspect) && aspect > 0))
    throw wrongArgument('aspect', aspect, 'the width of the image over its height');
  if (!(typeof fovYDegrees === 'number' && fovYDegrees > 0 && fovYDegrees < 180))
    throw wrongArgument('fovYDegrees', fovYDegrees, 'an angle above 0° and below 180°');
  if (up !== undefined) checkVector('up', up, 'a direction in the world', { isDirection: true });
  checkOneOf('kind', kind, KINDS);
  checkKind('clouds', clouds, 'a list');
  for (const instance of clouds) {
    const { cloud, modelMatrix, instances, opacity = 1 } = given(instance, {}, 'clouds');
    given(cloud, CLOUD, 'cloud').checkUsable();
    if (modelMatrix) checkMatrix('modelMatrix', modelMatrix, cloud.name);
    if (instances) checkInstances(instances, cloud);
    if (!(typeof opacity === 'number' && opacity >= 0 && opacity <= 1))
      throw wrongArgument('opacity', opacity, 'a number, 0…1', cloud.name);
  }
}

function placedCloud({ cloud, modelMatrix, instances, opacity = 1 }: CloudInstance): PlacedCloud {
  const matrices = worldMatrices({
    modelMatrix: modelMatrix ?? undefined,
    instances: instances ?? undefined,
  });
  const opacities = matrices.map((_, i) => opacity * (instances?.opacities?.[i] ?? 1));
  return { cloud, matrices, opacities };
}

/** Up as it is known, and as it mostly is. */
function upOf(placed: readonly PlacedCloud[], up: Vec3 | undefined): Pick<FramingWishes, 'up' | 'usualUp'> {
  const inWorld = ({ cloud, matrices }: PlacedCloud) =>
    turned(fileUp(cloud.facts) ?? USUAL_UP, linearPart(matrices[0]));
  const isDefined = placed.every(({ cloud }) => fileUp(cloud.facts) !== null);
  const usualUp = inWorld(placed[0]);
  if (up) return { up: unit([up[0], up[1], up[2]]) ?? usualUp, usualUp };
  return { up: isDefined ? usualUp : null, usualUp };
}

/** A direction in the world; as it is if the matrix leaves none. */
function turned(direction: Vec3, matrix: readonly number[]): Vec3 {
  return unit(transform3(matrix, direction)) ?? direction;
}

/** The direction of a vector of any length; null for one without. */
function unit(vector: Vec3): Vec3 | null {
  // Scaled first, so that no square leaves the range.
  const largest = Math.max(...vector.map(Math.abs));
  if (!(largest > 0 && Number.isFinite(largest))) return null;
  const [x, y, z] = vector.map((value) => value / largest);
  const length = Math.sqrt(x * x + y * y + z * z);
  return [x / length, y / length, z / length];
}
