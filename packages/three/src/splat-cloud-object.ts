import {
  type AccuracyChoice,
  type AccuracyRequest,
  type AccuracySettings,
  type ChooseAccuracyOptions,
  DestroyedError,
  InvalidArgumentError,
  raycastCloud,
  type ShDegree,
  type SplatCloud,
  type SplatEngine,
} from '@websplatter/core';
import { type EffectUse, fog } from '@websplatter/core/effects';
import {
  Box3,
  BufferGeometry,
  type Camera,
  type Fog,
  type FogExp2,
  type Intersection,
  Matrix4,
  Object3D,
  type Object3DEventMap,
  Ray,
  type Raycaster,
  type Scene,
  Sphere,
  Vector3,
  type WebGPURenderer,
} from 'three/webgpu';
import { fogOptionsOf } from './effect-options.ts';
import { SplatsPrecisionError } from './errors.ts';
import type { CloudLayer, LayerCloud } from './layer-cloud.ts';
import { type RevealAnimation, Revealing } from './reveal-animation.ts';
import type { SplatData } from './splat-data.ts';
import { layerOf, rootOf, type SplatLayer } from './splat-layer.ts';

/** The splat that contributes most to a pixel. */
export interface SplatHit {
  readonly object: SplatCloudObject;
  /** Row of the splat in its file. */
  readonly splatIndex: number;
  /** World space. */
  readonly point: Vector3;
  /** Depth along the camera's line of sight, world units. */
  readonly depthView: number;
  /** Its opacity at the pixel, 0…1. */
  readonly alpha: number;
}

export interface SplatCloudEventMap extends Object3DEventMap {
  /** The first picture with the present data is being drawn. */
  firstframe: object;
  /** The next picture will be another one though nothing in the scene has changed: shaders or data have become ready. */
  needsframe: object;
  /** Settings have been chosen for a picture with this cloud, since a cloud in it or its renderer wishes for an outcome. */
  accuracychosen: { readonly choice: AccuracyChoice };
}

/**
 * A cloud of splats anywhere in a scene. All clouds of a scene are sorted together, whatever their transforms, and drawn
 * among its transparent objects by where their common bounds lie (`renderOrder`: the highest of theirs). Shearing, mirroring
 * and scaling transforms are all right; `visible` and `layers` are as in meshes.
 */
export class SplatCloudObject extends Object3D<SplatCloudEventMap> implements LayerCloud {
  readonly isSplatCloudObject = true;
  /** Multiplies every splat's opacity, 0…1. */
  opacity = 1;
  /** Colours depend on the view up to this degree of spherical harmonics, at most. */
  shDegree: ShDegree = 3;
  /** Effects of `@websplatter/core/effects`, or of your own, each once: `[tint([1, 0.8, 0.6])]`. What is in use costs time. */
  effects: readonly EffectUse[] = [];
  /** Whether the fog of the scene (Fog, FogExp2) hides splats as it does meshes, where `effects` have no `fog` of their own. */
  fog = true;
  /**
   * Whether this cloud's splats, where they cover more than half of a pixel, hide what is drawn after them, and are seen by
   * effects that read depth. Clouds in view share one layer: one that writes makes all write.
   */
  writesDepth = false;
  /**
   * How exactly splats are drawn, and how fast: settings, or a wish (`{ minPsnrDb: 45 }`, `{ maxFrameMs: 8 }`) for which
   * settings are measured and chosen; null: as the renderer's accuracy says. Clouds in view are one picture, which has one
   * accuracy: the most decibels that any wishes for, else settings, each at the most exact value that any asks for, else the
   * shortest time. What the GPU holds of the splats follows in the background, the old picture staying meanwhile.
   */
  accuracy: AccuracyRequest | null = null;
  /**
   * Told once of each thing that keeps the cloud from being drawn, or from being drawn as exactly as asked for (a
   * SplatsPrecisionError); without it that goes to the console.
   */
  onError: ((error: Error) => void) | null = null;
  /** Empty but for its bounds, by which Box3.setFromObject and all that measures with it see the cloud. */
  readonly geometry = withBounds(new BufferGeometry(), new Box3());
  /** @internal Bounds in world space, as of the last update of the world matrix. */
  readonly worldBounds = new Box3();
  readonly #uploads = new Map<SplatEngine, SplatCloud>();
  readonly #failed = new Set<SplatEngine>();
  /** The answers to what has been asked of the GPU's copies, to hear each once. */
  readonly #heard = new WeakSet<Promise<void>>();
  readonly #told = new Set<string>();
  #data: SplatData | null = null;
  #revealing: Revealing | null = null;
  #layer: SplatLayer | null = null;
  #isAnnounced = false;
  #choice: AccuracyChoice | null = null;

  constructor(data: SplatData | null = null) {
    super();
    this.data = data;
    this.addEventListener('removed', () => this.#layer && this.leave(this.#layer));
  }

  /** What is drawn. May be replaced at any time; the GPU's copy of the former goes with its last user. */
  get data(): SplatData | null {
    return this.#data;
  }

  set data(data: SplatData | null) {
    if (data === this.#data) return;
    this.#releaseUploads();
    this.#data = data;
    this.#isAnnounced = false;
    this.#revealing &&= new Revealing(this.#revealing.animation);
    withBounds(this.geometry, data?.robustBounds.clone() ?? new Box3());
    this.requestFrame();
  }

  /**
   * How the cloud is to appear by itself: once from the first picture after this was set, and again from the first one of
   * other data. The frames that it takes are asked for by `needsframe`. Null: it is simply there.
   *
   * @throws InvalidArgumentError for what is no place, width or time.
   */
  get reveal(): RevealAnimation | null {
    return this.#revealing?.animation ?? null;
  }

  set reveal(animation: RevealAnimation | null) {
    this.#revealing = animation && new Revealing(animation);
  }

  override updateMatrixWorld(force?: boolean): void {
    super.updateMatrixWorld(force);
    this.worldBounds.copy(this.geometry.boundingBox!).applyMatrix4(this.matrixWorld);
    const root = rootOf(this);
    if (root === this) return;
    const layer = layerOf(root);
    if (this.#layer !== layer) {
      this.#layer?.drop(this);
      this.#layer = layer;
    }
    layer.place(this);
  }

  /** Adds the nearest hit of the ray with the bounds of the cloud's chunks; `pick` finds the exact splat. */
  override raycast(raycaster: Raycaster, intersects: Intersection[]): void {
    if (!this.#data || this.matrixWorld.determinant() === 0) return;
    const { origin, direction } = new Ray()
      .copy(raycaster.ray)
      .applyMatrix4(new Matrix4().copy(this.matrixWorld).invert());
    const hit = raycastCloud(this.#data.packed, origin.toArray(), direction.toArray());
    if (!hit) return;
    const point = new Vector3(...hit.point).applyMatrix4(this.matrixWorld);
    const distance = raycaster.ray.origin.distanceTo(point);
    if (distance >= raycaster.near && distance <= raycaster.far)
      intersects.push({ distance, point, object: this });
  }

  /**
   * The splat of this cloud that contributes most to a pixel of what `renderer` has drawn last from `camera`; null where it
   * is another cloud's, where there is none, and before the first picture.
   *
   * @param xPx, yPx physical pixels from the canvas's top left.
   */
  async pick(renderer: WebGPURenderer, camera: Camera, xPx: number, yPx: number): Promise<SplatHit | null> {
    const hit = await this.#layer?.pick(renderer, camera, xPx, yPx);
    if (hit?.object !== this) return null;
    const { splatIndex, point, depthView, alpha } = hit;
    return { object: this, splatIndex, point: new Vector3(...point), depthView, alpha };
  }

  /**
   * Measures again what meets the wish of the picture that this cloud was drawn in last. What is drawn until then, and where
   * that fails, stays. An `accuracychosen` event tells all clouds of the picture.
   *
   * @throws InvalidArgumentError where the cloud has not been drawn, or not under a wish; the signal's reason; an AbortError
   *   where a later measurement takes over; DestroyedError.
   */
  async chooseAccuracy(options?: ChooseAccuracyOptions): Promise<AccuracyChoice> {
    const choosing = this.#layer?.chooseAccuracy(this, options);
    if (choosing) return choosing;
    const message = 'The cloud has not been drawn yet: there is no picture that could be measured.';
    throw new InvalidArgumentError('chooseAccuracy', message);
  }

  override copy(source: this, recursive?: boolean): this {
    super.copy(source, recursive);
    this.data = source.data;
    this.opacity = source.opacity;
    this.shDegree = source.shDegree;
    this.effects = source.effects;
    this.fog = source.fog;
    this.reveal = source.reveal;
    this.writesDepth = source.writesDepth;
    this.accuracy = source.accuracy;
    return this;
  }

  /** Takes the cloud off the screen and gives back its part of the GPU's memory. Drawn again, it is uploaded again. */
  override dispose(): void {
    if (this.#layer) this.leave(this.#layer);
    this.#releaseUploads();
    // Before 0.187 three's objects have none.
    super.dispose?.();
  }

  /** @internal No longer in the scene of `layer`. */
  leave(layer: CloudLayer): void {
    if (this.#layer === layer) this.#layer = null;
    layer.drop(this);
  }

  /** @internal The cloud on `engine`, uploaded where it is not there yet; null without data, and where that fails. */
  uploadedTo(engine: SplatEngine): SplatCloud | null {
    const uploaded = this.#uploads.get(engine);
    if (uploaded || !this.#data || this.#failed.has(engine)) return uploaded ?? null;
    try {
      const cloud = this.#data.acquire(engine, this);
      this.#uploads.set(engine, cloud);
      return cloud;
    } catch (error) {
      this.#failed.add(engine);
      // Of a lost device its renderer tells.
      if (!(error instanceof DestroyedError || this.tell(error))) console.error(error);
      return null;
    }
  }

  /**
   * @internal Has the cloud on `engine`, where it was uploaded, hold what `settings` ask for; null: its view sees to that.
   * Tells where that fails, and asks for a frame where it changes the picture.
   */
  hold(engine: SplatEngine, settings: AccuracySettings | null): void {
    const data = this.#data!;
    const answer = data.hold(engine, this, settings);
    if (!answer || !settings || this.#heard.has(answer)) return;
    this.#heard.add(answer);
    const cloud = this.#uploads.get(engine)!;
    const before = cloud.pagesFor(settings);
    answer.then(
      () => {
        if (this.#data === data && cloud.pagesFor(settings) !== before) this.requestFrame();
      },
      (cause: Error) => {
        const isOver = this.#data !== data || cause.name === 'AbortError' || cause instanceof DestroyedError;
        if (isOver) return;
        const error = new SplatsPrecisionError(cause);
        if (!this.tell(error)) console.warn(error);
      },
    );
  }

  /** @internal Tells the listener of an error, once; false where there is none. */
  tell(error: unknown): boolean {
    if (!this.onError) return false;
    const text = String(error);
    if (!this.#told.has(text)) {
      this.#told.add(text);
      this.onError(error as Error);
    }
    return true;
  }

  /** @internal */
  requestFrame(): void {
    this.dispatchEvent({ type: 'needsframe' });
  }

  /** @internal What it is to be drawn with in a picture of `scene` at this moment. */
  effectsAt(nowMs: number, scene: Scene, camera: Camera): readonly EffectUse[] {
    const uses = [...this.effects];
    if (this.#revealing) uses.push(this.#revealing.useAt(nowMs, this.worldBounds, camera));
    const hasOwnFog = uses.some(({ effect }) => effect === fog.effect);
    if (scene.fog && this.fog && !hasOwnFog) uses.push(fog(fogOptionsOf(scene.fog as Fog | FogExp2)));
    return uses;
  }

  /** @internal A picture with this cloud, as it is at this moment, is being drawn. */
  announceDrawn(nowMs: number): void {
    this.#announceFirstFrame();
    if (!this.#revealing || this.#revealing.isOver(nowMs)) return;
    this.#revealing.begin(nowMs);
    // three is in the middle of its frame.
    queueMicrotask(() => this.requestFrame());
  }

  #announceFirstFrame(): void {
    if (this.#isAnnounced) return;
    this.#isAnnounced = true;
    // three is in the middle of its frame.
    queueMicrotask(() => this.dispatchEvent({ type: 'firstframe' }));
  }

  /** @internal This was chosen for a picture with this cloud. */
  announceAccuracy(choice: AccuracyChoice): void {
    // Several views of a scene share a choice.
    if (choice === this.#choice) return;
    this.#choice = choice;
    this.dispatchEvent({ type: 'accuracychosen', choice });
  }

  #releaseUploads(): void {
    for (const engine of this.#uploads.keys()) this.#data?.release(engine, this);
    this.#uploads.clear();
    this.#failed.clear();
    this.#told.clear();
  }
}

function withBounds(geometry: BufferGeometry, bounds: Box3): BufferGeometry {
  geometry.boundingBox = bounds;
  geometry.boundingSphere = bounds.getBoundingSphere(new Sphere());
  return geometry;
}
