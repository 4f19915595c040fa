import { type CloudInstance, frameScene, type SceneFraming, type SceneKind } from '@websplatter/core';
import {
  type Camera,
  type Object3D,
  type OrthographicCamera,
  type PerspectiveCamera,
  Vector3,
} from 'three/webgpu';
import { adoptRenderer, splatEngineOf } from '../renderer/adopt-renderer.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';

/** Options of `frameSplats`. */
export interface FrameSplatsOptions {
  /**
   * Up direction in world space, of any length above 0. Default: as the format of the files defines
   * it (glTF), else as estimated from floors and walls.
   */
  readonly up?: Vector3;
  /** Kind of scene, such as an object or a room. Default: detected. */
  readonly kind?: SceneKind;
  /** Cancels the work. */
  readonly signal?: AbortSignal;
}

/** A camera in perspective or an orthographic one. */
export type FramingCamera = PerspectiveCamera | OrthographicCamera;

/** An orthographic camera gets the extent of a view with this vertical field of view, in degrees. */
const ORTHOGRAPHIC_FOV = 50;
/** Near plane, in parts of the distance to the target: as near as depths of 24 bits bear. */
const NEAREST_PART = 1 / 1000;
/** Far plane, in parts of the distance to the target: skies are up to 1,000 radii of the detail away. */
const FARTHEST_PART = 10_000;

/**
 * Finds where to place `camera`, so that it shows the splats as a photographer would: upright, from
 * where most of their detail is sharp, in the picture and unhidden. Looks at the visible clouds in
 * `scene`, wherever they are in the world, and uploads them if necessary. Takes about 0.2 s; the
 * camera stays as it is until `placeCamera`.
 *
 * @param scene the scene, or any object in it.
 * @param camera the shape of its image counts.
 * @returns null if no splat can be seen, and for previews that another renderer loads.
 * @throws InvalidArgumentError naming the invalid option; SplatsUnsupportedRendererError for a
 *   renderer that cannot draw splats; DestroyedError if splats or engine end first; GpuLimitError if
 *   memory is lacking; the errors of reading; the signal's reason.
 * @example
 * const framing = await frameSplats(renderer, scene, camera);
 * if (framing) placeCamera(camera, framing);
 * const controls = new OrbitControls(camera, renderer.domElement);
 * if (framing) controls.target.set(...framing.target);
 */
export async function frameSplats(
  renderer: object,
  scene: Object3D,
  camera: Camera,
  { up, kind, signal }: FrameSplatsOptions = {},
): Promise<SceneFraming | null> {
  const engine = splatEngineOf(await adoptRenderer(renderer));
  signal?.throwIfAborted();
  const objects: SplatCloudObject[] = [];
  scene.traverseVisible((object) => {
    if (object instanceof SplatCloudObject && object.data) objects.push(object);
  });
  const placed = await Promise.all(
    objects.map(async (object): Promise<CloudInstance | null> => {
      const data = object.data!;
      // `object` becomes a user, as when it is drawn, so that the upload stays for drawing.
      const acquired = data.acquire(engine, object);
      if (data.isPreview && acquired instanceof Promise) return null;
      const cloud = await acquired;
      object.updateWorldMatrix(true, false);
      const modelMatrix = [...object.matrixWorld.elements];
      return { cloud, modelMatrix, instances: object.instances?.drawn(), opacity: object.drawnOpacity };
    }),
  );
  const clouds = placed.filter((each) => each !== null);
  return frameScene(clouds, { ...shapeOf(camera as FramingCamera), up: up?.toArray(), kind, signal });
}

/**
 * Places a camera as `frameSplats` found it: position, direction and `up`, near and far, and the
 * zoom of an orthographic one. Controls that turn about a target take `framing.target`; three's
 * OrbitControls read `camera.up` when they are made.
 *
 * @example
 * const framing = await frameSplats(renderer, scene, camera);
 * if (framing) placeCamera(camera, framing);
 */
export function placeCamera(camera: FramingCamera, framing: SceneFraming): void {
  const { position, target, up, radius, fovYDegrees } = framing;
  const aim = new Vector3(...target);
  const place = new Vector3(...position);
  const distance = place.distanceTo(aim);
  camera.parent?.updateWorldMatrix(true, false);
  camera.position.copy(camera.parent ? camera.parent.worldToLocal(place) : place);
  camera.up.set(...up);
  camera.lookAt(aim);
  camera.near = Math.min(camera.near, distance * NEAREST_PART);
  camera.far = Math.max(camera.far, FARTHEST_PART * Math.max(distance, radius));
  if (!isPerspective(camera)) {
    const halfHeight = distance * Math.tan((fovYDegrees * Math.PI) / 360);
    camera.zoom = Math.abs(camera.top - camera.bottom) / (2 * halfHeight);
  }
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
}

/** The shape of a camera's image, as `frameScene` takes it. */
function shapeOf(camera: FramingCamera): { readonly aspect: number; readonly fovYDegrees: number } {
  if (isPerspective(camera)) return { aspect: camera.aspect, fovYDegrees: camera.getEffectiveFOV() };
  const { left, right, top, bottom } = camera;
  return { aspect: Math.abs((right - left) / (top - bottom)), fovYDegrees: ORTHOGRAPHIC_FOV };
}

function isPerspective(camera: FramingCamera): camera is PerspectiveCamera {
  return (camera as PerspectiveCamera).isPerspectiveCamera;
}
