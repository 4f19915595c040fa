import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { AccuracyRequest } from '../data/accuracy/accuracy-target.ts';
import { type Camera, checkDepths } from '../data/camera/camera.ts';
import { InvalidArgumentError } from '../data/errors.ts';
import { CLOUD, given } from '../data/given.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import { shown } from '../data/printable.ts';
import { SORTED_BY, type SortBy } from '../data/splats/sort-by.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../data/splats/splat-set.ts';
import type { EffectUse } from '../gpu/effects/effect.ts';
import { checkVector, invalidOption } from '../gpu/effects/option-checks.ts';

/** A cloud, its place and how to draw it. */
export interface CloudInstance {
  readonly cloud: SplatCloud;
  /** Scene to world, 16 numbers, column-major, read in float64; default the identity. */
  readonly modelMatrix?: ArrayLike<number>;
  /** Multiplies every splat's opacity, 0…1; default 1. At 0 the cloud is not drawn. */
  readonly opacity?: number;
  /**
   * Highest degree of spherical harmonics to evaluate; stored bands above it are not read. Default
   * 3: the degree that is stored, within the frame's accuracy.
   */
  readonly shDegree?: ShDegree;
  /** Effects to draw this cloud with, each at most once: `[tint([1, 0.8, 0.6])]`. */
  readonly effects?: readonly EffectUse[];
}

/** A caller's request to a view to draw one frame. */
export interface FrameRequest {
  readonly camera: Camera;
  /** Their order is that in which equal depths are drawn. */
  readonly clouds: readonly CloudInstance[];
  /** Size in physical pixels, whole numbers; nothing is drawn if either is 0. */
  readonly widthPx: number;
  readonly heightPx: number;
  /** Colour behind the splats on a canvas, sRGB-encoded, 0…1; default black. */
  readonly background?: Vec3;
  /**
   * Settings, or a target: see `SplatView.onAccuracyChosen`. Default the engine's. Pass the same
   * object every frame: each object is read once.
   */
  readonly accuracy?: AccuracyRequest;
  /** The order in which splats are blended; default `auto`: as the clouds' files ask. */
  readonly sortBy?: SortBy;
  /** Draw even if nothing has changed, e.g. for a benchmark. */
  readonly force?: boolean;
}

/** @throws InvalidArgumentError */
function checkCamera(camera: Camera): void {
  for (const name of ['viewMatrix', 'projectionMatrix', 'wholeProjectionMatrix'] as const) {
    const isLeftOut = name === 'wholeProjectionMatrix' && camera[name] === undefined;
    if (!isLeftOut && !isMatrix(camera?.[name])) {
      throw new InvalidArgumentError(name, `The camera's ${name} must be 16 finite numbers, column-major.`);
    }
  }
  checkDepths(camera.near, camera.far);
}

function isMatrix(values: ArrayLike<number> | undefined): boolean {
  return values?.length === 16 && Array.prototype.every.call(values, Number.isFinite);
}

/**
 * @throws InvalidArgumentError naming the invalid argument and the reason, DestroyedError for a
 *   destroyed cloud, GpuLimitError for one that found no memory.
 */
export function checkRequest(request: FrameRequest, device: GPUDevice): void {
  const { camera, clouds, widthPx, heightPx, background = [0, 0, 0], sortBy = 'auto' } = request ?? {};
  if (!(Number.isInteger(widthPx) && Number.isInteger(heightPx) && widthPx >= 0 && heightPx >= 0)) {
    throw new InvalidArgumentError(
      'widthPx',
      `The image size is ${shown(widthPx)}×${shown(heightPx)}; use whole numbers of pixels.`,
    );
  }
  checkCamera(camera);
  if (!SORTED_BY.includes(sortBy)) {
    throw invalidOption('sortBy', sortBy, SORTED_BY.join(' or '));
  }
  checkVector('background', background, 'the sRGB-encoded colour behind the splats');
  if (!Array.isArray(clouds) || [...clouds].some((instance) => !instance?.cloud)) {
    throw new InvalidArgumentError('clouds', `clouds is ${shown(clouds)}; it must be a list of { cloud }.`);
  }
  for (const { cloud, modelMatrix, shDegree = 3 } of clouds as readonly CloudInstance[]) {
    given(cloud, CLOUD, 'cloud').checkUsable();
    if (cloud.device !== device) {
      const message = `${cloud.name} is on another GPU device than this view; load it with the engine that draws it.`;
      throw new InvalidArgumentError('clouds', message);
    }
    if (modelMatrix && !isMatrix(modelMatrix)) {
      const message = `The model matrix of ${cloud.name} must be 16 finite numbers, column-major.`;
      throw new InvalidArgumentError('modelMatrix', message);
    }
    if (typeof shDegree !== 'number' || !Object.hasOwn(SH_REST_COEFFICIENTS, shDegree)) {
      const message = `${cloud.name} cannot be drawn with degree ${shown(shDegree)}; use 0, 1, 2 or 3.`;
      throw new InvalidArgumentError('shDegree', message);
    }
  }
  const limitPx = device.limits.maxTextureDimension2D;
  if (Math.max(widthPx, heightPx) > limitPx) {
    const message = `An image of ${widthPx}×${heightPx} px is larger than this device's ${limitPx} px (maxTextureDimension2D).`;
    throw new InvalidArgumentError('widthPx', message);
  }
}
