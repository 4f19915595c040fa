import {
  DestroyedError,
  InvalidArgumentError,
  makeRayTree,
  type PackedCloud,
  type RayTree,
} from '@websplatter/core';
import {
  type EffectUse,
  type RevealOptions,
  reveal,
  type Volume,
  volumeClearance,
  volumes,
} from '@websplatter/core/effects';
import {
  Camera,
  type Intersection,
  Matrix4,
  type Object3D,
  OrthographicCamera,
  PerspectiveCamera,
  type Ray,
  type Raycaster,
  Scene,
  Vector3,
} from 'three/webgpu';
import type { LayerCloud } from '../layer/layer-cloud.ts';
import { engineCamera } from '../layer/layer-request.ts';
import { layersAround } from '../layer/splat-layer.ts';
import type { PlacedData } from './data-edits.ts';
import type { SplatInstances } from './splat-instances.ts';
import { tellOfRays } from './tell-of-rays.ts';

/** An object that shows splats to rays: a SplatCloudObject. */
export interface RayTarget extends Object3D {
  readonly drawnOpacity: number;
  readonly instances: SplatInstances | null;
  /** Time that a moving scene is shown at; null: its first. */
  readonly time: number | null;
  /** Null while code of effects is loaded; the splats are not drawn then. */
  effectsAt(nowMs: number, scene: Scene, camera: Camera): readonly EffectUse[] | null;
  /** Passes an error to the listener, once per text; returns false without a listener. */
  tell(error: unknown): boolean;
}

/** Adds the hit of a ray with the splats of `object` in each of its places, if there is one. */
export type CastRay = (object: RayTarget, raycaster: Raycaster, intersects: Intersection[]) => void;

/** Factor of a splat's opacity at a point in world space, 0…1. */
type ShownAt = (point: Vector3) => number;

/** A scene without fog: fog does not stop rays. */
const NO_SCENE = new Scene();

/** A tree, with the state of the splats that it was made of. */
interface HeldTree {
  readonly tree: RayTree;
  /** See `PlacedEdits.version`. */
  readonly version: number;
  /** Time of a moving scene; undefined of others. */
  readonly time: number | undefined;
}

/**
 * Makes the tree that rays are tested against, from splats in memory or on the first engine that
 * has them; of a moving scene at `time`. After edits, and if an object shows another time, the next
 * ray requests a new tree.
 *
 * @throws DestroyedError if the splats are nowhere, and as `makeRayTree` does.
 */
export async function rayCaster(
  data: PlacedData,
  packed: PackedCloud | null,
  time: number | null,
): Promise<CastRay> {
  let prepared = await treeOf(data, packed, timeOf(data, time));
  const renewed = new WeakMap<object, HeldTree>();
  const renewing = new WeakSet<object>();
  return (object, raycaster, intersects) => {
    // Each object may show a moving scene at a time of its own.
    const owner = data.timeRange ? object : data;
    const held = renewed.get(owner) ?? prepared;
    try {
      castRay(held.tree, object, raycaster, intersects);
    } catch (error) {
      // Invalid options: the next frame reports them.
      if (!(error instanceof InvalidArgumentError)) throw error;
    }
    const timeNow = timeOf(data, object.time);
    if ((held.version === versionOf(data) && held.time === timeNow) || renewing.has(owner)) return;
    // Rays use the old tree until the new one is made.
    renewing.add(owner);
    treeOf(data, data.packed, timeNow)
      .then((made) => {
        if (owner === data) prepared = made;
        else renewed.set(owner, made);
      })
      .catch((error: Error) => tellOfRays(object, error))
      .finally(() => renewing.delete(owner));
  };
}

function versionOf({ edits }: PlacedData): number {
  return edits?.version ?? 0;
}

function timeOf({ timeRange }: PlacedData, time: number | null): number | undefined {
  if (!timeRange) return undefined;
  const [from, to] = timeRange;
  return Math.max(from, Math.min(to, time ?? from));
}

async function treeOf(
  data: PlacedData,
  packed: PackedCloud | null,
  time: number | undefined,
): Promise<HeldTree> {
  const { name, edits, places } = data;
  const version = versionOf(data);
  // Packed splats lack edits; an engine's copy has them.
  if (packed && !edits) return { tree: await makeRayTree(packed, { time }), version, time };
  const [place] = places;
  if (!place) throw new DestroyedError(`The cloud ${name}`, 'it has been freed');
  return { tree: await makeRayTree(await place.cloud, { time }), version, time };
}

function castRay(tree: RayTree, object: RayTarget, raycaster: Raycaster, intersects: Intersection[]): void {
  const { ray, camera } = raycaster;
  const view = viewOf(ray, camera);
  const shownAt = shownBy(object, ray, camera);
  const { instances, matrixWorld, drawnOpacity } = object;
  const castAt = (place: RayPlace) => castRayAt(tree, object, place, raycaster, intersects, view, shownAt);
  if (!instances) castAt({ matrixWorld, opacity: drawnOpacity });
  else
    for (let instanceId = 0; instanceId < instances.count; instanceId++)
      castAt({
        matrixWorld: instances.getMatrixAt(instanceId, new Matrix4()).premultiply(matrixWorld),
        opacity: drawnOpacity * instances.getOpacityAt(instanceId),
        instanceId,
      });
}

/** One placement of an object's splats: the object itself, or an instance. */
interface RayPlace {
  readonly matrixWorld: Matrix4;
  readonly opacity: number;
  /** Index of the instance; undefined for an object without instances. */
  readonly instanceId?: number;
}

function castRayAt(
  tree: RayTree,
  object: RayTarget,
  { matrixWorld, opacity, instanceId }: RayPlace,
  { ray, near, far }: Raycaster,
  intersects: Intersection[],
  view: RaysCamera | null,
  shownAt: ShownAt | undefined,
): void {
  if (matrixWorld.determinant() === 0) return;
  const toLocal = new Matrix4().copy(matrixWorld).invert();
  const origin = ray.origin.clone().applyMatrix4(toLocal);
  // Not normalised: its length is one world unit in the cloud's space, so distances are world units.
  const direction = ray.origin.clone().add(ray.direction).applyMatrix4(toLocal).sub(origin);
  const point = new Vector3();
  const found = tree.cast(origin.toArray(), direction.toArray(), {
    near: Math.max(near, view?.near ?? 0),
    far: Math.min(far, view?.far ?? Number.POSITIVE_INFINITY),
    opacity,
    view: view
      ? {
          camera: engineCamera(view.camera, false),
          modelMatrix: matrixWorld.elements,
          heightPx: imageHeightPx(object),
        }
      : undefined,
    shownAt: shownAt && ((x, y, z) => shownAt(point.set(x, y, z).applyMatrix4(matrixWorld))),
  });
  if (!found) return;
  const { distance } = found;
  const hit = { distance, point: ray.at(distance, new Vector3()), object };
  intersects.push(instanceId === undefined ? hit : { ...hit, instanceId });
}

/** Returns the height in physical pixels of the latest image of `object`; undefined if none. */
function imageHeightPx(object: RayTarget): number | undefined {
  const cloud = object as Object3D as LayerCloud;
  const [view] = layersAround(cloud).flatMap(({ views }) => views.latestWith(cloud) ?? []);
  return (view?.color?.sourceTexture as GPUTexture | undefined)?.height;
}

/** The camera of a ray's picture, and the distances between which it draws along the ray. */
interface RaysCamera {
  readonly camera: PerspectiveCamera | OrthographicCamera;
  readonly near: number;
  readonly far: number;
}

/** Returns null for rays that do not begin at the camera, or lie outside of its view. */
function viewOf(ray: Ray, camera: Camera | null | undefined): RaysCamera | null {
  if (!(camera instanceof PerspectiveCamera || camera instanceof OrthographicCamera)) return null;
  const { matrixWorld, projectionMatrix, near, far } = camera;
  // A canvas without a size gives a singular projection.
  if (!Number.isFinite(1 / projectionMatrix.determinant())) return null;
  const forward = new Vector3().setFromMatrixColumn(matrixWorld, 2).normalize().negate();
  const along = forward.dot(ray.direction);
  // Rays of an orthographic camera begin where it draws.
  if (camera instanceof OrthographicCamera)
    return along > 1 - 1e-6 ? { camera, near: 0, far: Number.POSITIVE_INFINITY } : null;
  const isFromCamera = ray.origin.distanceTo(new Vector3().setFromMatrixPosition(matrixWorld)) <= near;
  return isFromCamera && along > 0 ? { camera, near: near / along, far: far / along } : null;
}

/** Returns the factor of opacity by `volumes` and `reveal`; undefined without these effects. */
function shownBy(object: RayTarget, ray: Ray, camera: Camera | null | undefined): ShownAt | undefined {
  const viewer = camera ?? viewerAt(ray.origin);
  const uses = object.effectsAt(performance.now(), NO_SCENE, viewer);
  if (!uses) return () => 0;
  const factors = uses.map((use) => shownByEffect(use, viewer)).filter((factor) => factor !== null);
  if (factors.length === 0) return undefined;
  return (point) => factors.reduce((shown, factor) => shown * factor(point), 1);
}

function viewerAt(position: Vector3): Camera {
  const camera = new Camera();
  camera.matrixWorld.setPosition(position);
  return camera;
}

function shownByEffect({ effect, options }: EffectUse, viewer: Camera): ShownAt | null {
  if (effect === reveal.effect) {
    const { from, radius, softEdge = 0 } = options as RevealOptions;
    const start =
      from === 'camera' ? new Vector3().setFromMatrixPosition(viewer.matrixWorld) : new Vector3(...from);
    return (point) => edgeFade(radius - point.distanceTo(start), softEdge);
  }
  if (effect !== volumes.effect) return null;
  const fading = (options as readonly Volume[]).filter(({ mode }) => mode !== 'tint' && mode !== 'displace');
  if (fading.length === 0) return null;
  const factors = fading.map((volume) => {
    const clearance = volumeClearance(volume);
    const least = volume.mode === 'fade' ? volume.opacity : 0;
    return ({ x, y, z }: Vector3) => {
      const away = edgeFade(clearance([x, y, z]), volume.softEdge ?? 0);
      return least + (1 - least) * away;
    };
  });
  return (point) => factors.reduce((shown, factor) => shown * factor(point), 1);
}

/** Factor of opacity at a distance inside of an edge: smoothstep over its width. */
function edgeFade(depth: number, softEdge: number): number {
  if (depth <= 0) return 0;
  if (depth >= softEdge) return 1;
  const t = depth / softEdge;
  return t * t * (3 - 2 * t);
}
