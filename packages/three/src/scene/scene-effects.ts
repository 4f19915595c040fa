import {
  type EffectUse,
  fog,
  type RevealOptions,
  reveal,
  type Volume,
  volumes,
} from '@websplatter/core/effects';
import { type Box3, type Camera, type Object3D, type Scene, Vector3 } from 'three/webgpu';
import { isShown, layersAround, rootOf } from '../layer/splat-layer.ts';
import { clippingOf } from './clipping-groups.ts';
import { isAnimation, type RevealAnimation } from './reveal-animation.ts';
import { sceneFog } from './scene-fog.ts';
import { type SceneVolume, volumesIn } from './scene-volumes.ts';

/** Loaded when the lights of a scene light a cloud. */
let light: typeof import('./scene-relight.ts') | null = null;

/** The part of a cloud that decides its effects. */
interface CloudInScene extends Object3D {
  readonly drawnRelight: number;
  readonly reveal: RevealAnimation | RevealOptions | null;
  readonly fog: boolean;
  readonly worldBounds: Box3;
  requestFrame(): void;
  tell(error: unknown): boolean;
}

/**
 * Returns the effects of a cloud in a scene: its own, the reveal animation, clipping groups, volumes
 * of the scene, and the scene's light and fog unless the cloud has its own. Null while code for light
 * is loaded.
 *
 * @param own effects that the cloud has in any scene.
 * @param progress part of the reveal animation's time that has passed; complete from 1 on.
 * @throws InvalidArgumentError for fog, planes or volumes that effects cannot take.
 */
export function sceneEffects(
  cloud: CloudInScene,
  own: readonly EffectUse[],
  progress: number,
  scene: Scene,
  camera: Camera,
): EffectUse[] | null {
  const { reveal, drawnRelight } = cloud;
  if (drawnRelight !== 0 && !light) {
    loadLight(cloud);
    return null;
  }
  const around = volumesOn(cloud);
  const uses = [...own, ...(around.length > 0 ? [volumes(around)] : []), ...clippingOf(cloud)];
  if (reveal && isAnimation(reveal) && progress < 1)
    uses.push(revealUse(reveal, progress, cloud.worldBounds, camera));
  if (drawnRelight !== 0) uses.push(...light!.sceneRelight(scene, drawnRelight, own));
  const takesFog = cloud.fog && !own.some(({ effect }) => effect === fog.effect);
  return takesFog ? [...uses, ...sceneFog(scene)] : uses;
}

function loadLight(cloud: CloudInScene): void {
  import('./scene-relight.ts').then(
    (loaded) => {
      light = loaded;
      cloud.requestFrame();
    },
    (error) => cloud.tell(error),
  );
}

/** Default width of the band that fades in, as a part of the radius. */
const SOFT_PART = 0.3;

/**
 * Returns the effect that shows the part of a cloud that is revealed by now. Its radius grows with
 * the cube of time, so that near splats appear visibly however far the scene reaches, until the
 * farthest corner of the cloud's bounds has faded in.
 *
 * @param progress 0…1, the part of the animation's time that has passed.
 * @param bounds the cloud's, in world space.
 */
export function revealUse(
  { from, softEdge, grow }: RevealAnimation,
  progress: number,
  bounds: Box3,
  camera: Camera,
): EffectUse {
  const start =
    from === 'camera' ? new Vector3().setFromMatrixPosition(camera.matrixWorld) : new Vector3(...from);
  // The bounds of a cloud without splats are infinite and inside out.
  const farthest = new Vector3().max(bounds.max.clone().sub(start)).max(start.sub(bounds.min)).length();
  const end = softEdge === undefined ? farthest / (1 - SOFT_PART) : farthest + softEdge;
  const radius = end * progress ** 3;
  return reveal({ from, radius, softEdge: softEdge ?? SOFT_PART * radius, grow });
}

/** Returns the volumes of the scene that act on a cloud, in the order of the scene's tree. */
function volumesOn(cloud: Object3D): Volume[] {
  const root = rootOf(cloud);
  const found = [...(volumesIn(root) ?? [])].filter((volume) => rootOf(volume) === root && isShown(volume));
  if (found.length === 0) return [];
  /** All objects that are or contain clouds. */
  const holders = new Set<Object3D>();
  for (const { clouds } of layersAround(cloud))
    for (const each of [cloud, ...clouds]) for (const at of ancestry(each)) holders.add(at);
  const around = new Set(ancestry(cloud));
  const acts = (volume: SceneVolume) => {
    const holder = ancestry(volume).find((at) => at !== volume && holders.has(at));
    return holder !== undefined && around.has(holder);
  };
  const places = new Map(found.filter(acts).map((volume) => [volume, placeInTree(volume)]));
  return [...places.keys()]
    .sort((a, b) => comparePlaces(places.get(a)!, places.get(b)!))
    .map((volume) => volume.toVolume());
}

/** The object, its parent, and so on. */
function ancestry(object: Object3D): Object3D[] {
  const all: Object3D[] = [];
  for (let at: Object3D | null = object; at; at = at.parent) all.push(at);
  return all;
}

/** Index of each ancestor among its siblings, from the top down. */
function placeInTree(object: Object3D): number[] {
  return ancestry(object)
    .map((at) => at.parent?.children.indexOf(at) ?? 0)
    .reverse();
}

function comparePlaces(a: readonly number[], b: readonly number[]): number {
  const differing = a.findIndex((index, level) => index !== b[level]);
  // An object comes before the objects below it.
  if (differing < 0) return a.length - b.length;
  return differing < b.length ? a[differing] - b[differing] : 1;
}
