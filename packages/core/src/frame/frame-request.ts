import type { AccuracyRequest } from '../accuracy/accuracy-wish.ts';
import type { Camera } from '../camera/camera.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { EffectUse } from '../effects/effect.ts';
import { DestroyedError, InvalidArgumentError } from '../errors.ts';
import type { Vec3 } from '../math/mat4.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../splats/splat-set.ts';

/** A cloud and where it stands. */
export interface CloudInstance {
  readonly cloud: SplatCloud;
  /** Scene to world, 16 numbers, column-major, read in float64; default the identity. */
  readonly modelMatrix?: ArrayLike<number>;
  /** Multiplies every splat's opacity, 0…1; default 1. At 0 nothing of the cloud is drawn. */
  readonly opacity?: number;
  /**
   * Colours depend on the view up to this degree of spherical harmonics, at most: what is stored above it is not read.
   * Default 3, whatever is stored and the frame's accuracy asks for.
   */
  readonly shDegree?: ShDegree;
  /** Effects that this cloud is to be drawn with, each once: `[tint([1, 0.8, 0.6])]`. */
  readonly effects?: readonly EffectUse[];
}

/** One picture. */
export interface FrameRequest {
  readonly camera: Camera;
  /** In the order in which equal depths are drawn. */
  readonly clouds: readonly CloudInstance[];
  /** Size in physical pixels, whole numbers; nothing is drawn where one is 0. */
  readonly widthPx: number;
  readonly heightPx: number;
  /** What is behind the splats on a canvas, sRGB-encoded, 0…1; default black. */
  readonly background?: Vec3;
  /**
   * Settings, or a wish: see `SplatView.onAccuracyChosen`. Default the engine's. Pass the same object every frame, it is
   * looked at once.
   */
  readonly accuracy?: AccuracyRequest;
  /** Draw even where nothing has changed, as a benchmark needs it. */
  readonly force?: boolean;
}

function isMatrix(values: ArrayLike<number>): boolean {
  return values.length === 16 && Array.prototype.every.call(values, Number.isFinite);
}

/** @throws InvalidArgumentError naming what cannot be drawn and why, DestroyedError for a destroyed cloud. */
export function checkRequest({ camera, clouds, widthPx, heightPx }: FrameRequest, device: GPUDevice): void {
  if (!(Number.isInteger(widthPx) && Number.isInteger(heightPx) && widthPx >= 0 && heightPx >= 0)) {
    throw new InvalidArgumentError(
      'widthPx',
      `The picture is ${widthPx}×${heightPx}; it takes whole numbers of pixels.`,
    );
  }
  for (const name of ['viewMatrix', 'projectionMatrix'] as const) {
    if (!isMatrix(camera[name])) {
      throw new InvalidArgumentError(name, `The camera's ${name} must be 16 finite numbers, column-major.`);
    }
  }
  for (const { cloud, modelMatrix, shDegree = 3 } of clouds) {
    if (cloud.isDestroyed) throw new DestroyedError(`The cloud ${cloud.name}`, 'it was destroyed');
    if (cloud.device !== device) {
      const message = `${cloud.name} is on another GPU device than this view; load it with the engine that draws it.`;
      throw new InvalidArgumentError('clouds', message);
    }
    if (modelMatrix && !isMatrix(modelMatrix)) {
      const message = `The model matrix of ${cloud.name} must be 16 finite numbers, column-major.`;
      throw new InvalidArgumentError('modelMatrix', message);
    }
    if (!(shDegree in SH_REST_COEFFICIENTS)) {
      const message = `${cloud.name} is to be drawn with degree ${shDegree}; there are degrees 0, 1, 2 and 3.`;
      throw new InvalidArgumentError('shDegree', message);
    }
  }
}
