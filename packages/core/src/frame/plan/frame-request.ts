import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import type { AccuracyRequest } from '../../data/accuracy/accuracy-target.ts';
import { type Camera, checkDepths, checkMatrix } from '../../data/camera/camera.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { CLOUD, checkKind, given, wrongArgument } from '../../data/given.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { checkOneOf } from '../../data/packing/check-precision.ts';
import { checkDegree } from '../../data/splats/check-set.ts';
import { SORTED_BY, type SortBy } from '../../data/splats/sort-by.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import type { EffectUse } from '../../gpu/effects/effect.ts';
import { checkRange, checkVector } from '../../gpu/effects/option-checks.ts';
import { type CloudInstances, checkInstances } from './cloud-instances.ts';
import { checkDetail, type Detail } from './detail.ts';

/** A cloud, its place and how to draw it. */
export interface CloudInstance {
  readonly cloud: SplatCloud;
  /** Scene to world, 16 numbers, column-major, read in float64; default the identity. */
  readonly modelMatrix?: ArrayLike<number>;
  /**
   * Where to draw the cloud many times; default once, at `modelMatrix`. With the frame's `detail`,
   * each is drawn in the level that its distance asks for. Not for clouds that stream.
   */
  readonly instances?: CloudInstances;
  /**
   * Time at which a moving cloud is shown, in the unit of its file; default the first of
   * `SplatCloud.timeRange`. Times outside of that range show its ends. Clouds that stand still ignore it, and
   * so do files of frames, whose frames `openFrames` gives.
   */
  readonly time?: number;
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
  /**
   * Default `full`. Any other detail needs levels (`SplatCloud.makeLevels`); the first such frame starts
   * making them. Until they exist, the last frame's clouds are drawn as before; without a last frame
   * nothing is drawn. Clouds that are loading, or lack memory for levels, are drawn in full. If `detail`
   * is a target, `view.detail` is the detail last drawn, and `view.whenComplete` waits for the final one.
   */
  readonly detail?: Detail;
  /** @internal Only of embedded views: see `EmbeddedFrameRequest`. */
  readonly fade?: number;
  /** Draw even if nothing has changed, e.g. for a benchmark. */
  readonly force?: boolean;
}

/** @throws InvalidArgumentError */
function checkCamera(camera: Camera): void {
  const {
    viewMatrix,
    projectionMatrix,
    wholeProjectionMatrix = projectionMatrix,
  } = given(camera, {}, 'camera');
  for (const [name, matrix] of Object.entries({ viewMatrix, projectionMatrix, wholeProjectionMatrix }))
    checkMatrix(name, matrix);
  checkDepths(camera.near, camera.far);
}

/**
 * @throws InvalidArgumentError naming the invalid argument and the reason, DestroyedError for a
 *   destroyed cloud, GpuLimitError for one that found no memory.
 */
export function checkRequest(request: FrameRequest, device: GPUDevice): void {
  const {
    camera,
    clouds,
    widthPx,
    heightPx,
    background = [0, 0, 0],
    sortBy = 'auto',
    detail,
    fade = 1,
  } = request ?? {};
  for (const [name, value] of Object.entries({ widthPx, heightPx }))
    if (!(Number.isInteger(value) && value >= 0))
      throw wrongArgument(name, value, 'a whole number of pixels');
  checkCamera(camera);
  checkOneOf('sortBy', sortBy, SORTED_BY);
  checkDetail(detail);
  checkVector('background', background, 'the sRGB-encoded colour behind the splats');
  checkRange('fade', fade, 1, 'the share of the splats’ finished picture');
  checkKind('clouds', clouds, 'a list');
  for (const instance of clouds) {
    const { cloud, modelMatrix, instances, shDegree = 3 } = given(instance, {}, 'clouds');
    given(cloud, CLOUD, 'cloud').checkUsable();
    if (cloud.device !== device) {
      const message = `${cloud.name} is on another GPU device; load it with the engine that draws it.`;
      throw new InvalidArgumentError('clouds', message);
    }
    if (modelMatrix) checkMatrix('modelMatrix', modelMatrix, cloud.name);
    checkBuffers(instance, device);
    if (instances) checkInstances(instances, cloud);
    checkDegree('shDegree', shDegree, cloud.name);
  }
  const limitPx = device.limits.maxTextureDimension2D;
  if (Math.max(widthPx, heightPx) > limitPx) {
    const message = `An image of ${widthPx}×${heightPx} px is larger than this device's ${limitPx} px (maxTextureDimension2D).`;
    throw new InvalidArgumentError('widthPx', message);
  }
}

/** Storage buffers of the stage that draws a selection of splats that move. */
const BUFFERS_OF_MOVING_SELECTION = 9;

/** @throws InvalidArgumentError for a selection on a moving cloud, if the device binds too few buffers for both. */
function checkBuffers({ cloud, effects = [] }: CloudInstance, device: GPUDevice): void {
  const most = device.limits.maxStorageBuffersPerShaderStage;
  if (!cloud.timeRange || most >= BUFFERS_OF_MOVING_SELECTION) return;
  const selecting = effects.find((use) => use?.effect?.takesSelection && use.reason !== null);
  if (!selecting) return;
  const message = `${cloud.name} moves, and the effect ${selecting.effect.name} shows a selection: together they need ${BUFFERS_OF_MOVING_SELECTION} storage buffers, and this device allows ${most}. Request it by requestSplatDevice, or leave the effect out.`;
  throw new InvalidArgumentError('effects', message);
}
