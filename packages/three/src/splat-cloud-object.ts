import {
  type AccuracyChoice,
  type AccuracyRequest,
  type AccuracySettings,
  type ChooseAccuracyOptions,
  type CloudStream,
  callListener,
  DestroyedError,
  type Detail,
  GpuLimitError,
  InvalidArgumentError,
  type ShDegree,
  type SplatCloud,
  type SplatEngine,
  type SplatPick,
} from '@websplatter/core';
import { type EffectUse, type RevealOptions, reveal, type SplatEffect } from '@websplatter/core/effects';
import {
  Box3,
  BufferGeometry,
  type Camera,
  type Intersection,
  Object3D,
  type Object3DEventMap,
  type Raycaster,
  type Scene,
  Vector3,
  type WebGPURenderer,
} from 'three/webgpu';
import { dispatch } from './dispatch.ts';
import { SplatsPrecisionError, type SplatsStreamError } from './errors.ts';
import type { CloudLayer } from './layer-cloud.ts';
import { checkedReveal, isAnimation, type RevealAnimation } from './reveal-animation.ts';
import type { SplatData } from './splat-data.ts';
import type { SplatInstances } from './splat-instances.ts';
import { layerOf, rootOf, type SplatLayer, withBounds } from './splat-layer.ts';
import { StreamFollower } from './stream-follower.ts';

/** Code for effects that come from the scene or change with time: loaded when a cloud has some. */
let later: typeof import('./scene-effects.ts') | null = null;

/** The splat that contributes most to a pixel. */
export interface SplatHit {
  readonly object: SplatCloudObject;
  /** Row of the splat in its file. */
  readonly splatIndex: number;
  /** Index of the instance that it belongs to, of an object with `instances`. */
  readonly instanceId?: number;
  /** World space. */
  readonly point: Vector3;
  /** Depth along the camera's line of sight, world units. */
  readonly depthView: number;
  /** The splat's opacity at the pixel, 0…1. */
  readonly alpha: number;
}

/** @internal Returns a pick in three's terms. */
export function hitOf(pick: SplatPick): Omit<SplatHit, 'object'> {
  const { splatIndex, instanceIndex, point, depthView, alpha } = pick;
  const hit = { splatIndex, point: new Vector3(...point), depthView, alpha };
  return instanceIndex === null ? hit : { ...hit, instanceId: instanceIndex };
}

/** Events of a `SplatCloudObject`, besides those of every object. */
export interface SplatCloudEventMap extends Object3DEventMap {
  /** The first frame with the current data has been submitted; not dispatched for previews. */
  firstframe: object;
  /**
   * A frame has been submitted that shows all that views need of a scene that streams, as far as
   * there is room for it, after one that did not: again when the camera has moved to what was
   * missing. Of other scenes, with `firstframe`.
   */
  complete: object;
  /** The next frame will differ without a change of the scene: shaders or data are ready. */
  needsframe: object;
  /** Settings have been chosen for a frame with this cloud, for a renderer's or cloud's target. */
  accuracychosen: { readonly choice: AccuracyChoice };
}

/**
 * A cloud of splats anywhere in a scene. All clouds of a scene with the same `renderOrder` are
 * sorted together, whatever their transforms, and drawn as one of its transparent objects, which
 * lies in the middle of their common bounds. Transforms may shear, mirror and scale; `visible` and
 * `layers` work as on meshes.
 */
export class SplatCloudObject extends Object3D<SplatCloudEventMap> {
  override readonly type: string = 'SplatCloudObject';
  readonly isSplatCloudObject = true;
  /**
   * Multiplies every splat's opacity. Numbers beyond 0…1, as springs give them, count as the nearest
   * of these, which the console says once.
   */
  opacity = 1;
  /** Colours depend on the view up to this degree of spherical harmonics. */
  shDegree: ShDegree = 3;
  /**
   * Effects from `@websplatter/core/effects` or your own, each at most once: `[tint([1, 0.8,
   * 0.6])]`. Effects cost time.
   */
  effects: readonly EffectUse[] = [];
  /**
   * Whether the scene's fog (Fog, FogExp2) hides splats as it does meshes, unless `effects` has a
   * `fog` of its own. Of a `fogNode` splats follow range and density fog; beside another they take
   * the scene's `fog`, which meshes ignore then.
   */
  fog = true;
  /**
   * Whether splats that cover more than half of a pixel hide objects that are drawn after them, and
   * are visible to effects that read depth. It is the median depth of a pixel's splats: that of the
   * one that makes it more than half covered. Clouds with the same `renderOrder` share one layer:
   * if one writes depth, all do.
   */
  depthWrite = false;
  /**
   * How exactly and how fast to draw splats: settings, or a target (`{ minPsnrDb: 45 }`, `{
   * maxFrameMs: 8 }`) for which settings are measured and chosen; null: the renderer's accuracy.
   * All clouds in view with the same `renderOrder` share one frame and its accuracy. In order of
   * precedence, that is: the highest `minPsnrDb` that any cloud asks for; the settings that clouds
   * request, each at its most exact value; the lowest `maxFrameMs` that any cloud asks for. The
   * planes on the GPU follow in the background; the old image stays until they are ready.
   */
  accuracy: AccuracyRequest | null = null;
  /**
   * How much of the cloud to show: `full`, or blobs instead of splats wherever that moves their
   * light by less than about `{ maxErrorPx: 0.5 }`, or where more than `{ maxSplats: 1e6 }` are in
   * sight; null: the renderer's detail, which is `full` unless `createSplatRenderer` was told
   * otherwise. All clouds in view with the same `renderOrder` share one frame, which has the finest
   * detail that any of them asks for. The old image stays until the clouds' levels are made.
   */
  detail: Detail | null = null;
  /**
   * Where to draw the cloud many times, relative to this object; null: once. `raycast` and `pick`
   * tell which instance they met. Instances share all other properties and edits; each is drawn in
   * the level that `detail` and its distance ask for. Temporal effects take the object's motion for
   * theirs. Scenes that stream have none.
   */
  instances: SplatInstances | null = null;
  /**
   * Called once for each error that keeps the cloud from being drawn, or from being drawn as it is
   * now (with invalid options it stays as it was) or as exactly as requested (a
   * SplatsPrecisionError), and each time that parts of a scene that streams
   * cannot be fetched (a SplatsStreamError). Without a listener, errors go to the console.
   */
  onError: ((error: Error) => void) | null = null;
  /** Empty but for its bounds, by which Box3.setFromObject, and its users, include the cloud. */
  readonly geometry = withBounds(new BufferGeometry(), new Box3());
  /** @internal Bounds in world space, as of the last update of the world matrix. */
  readonly worldBounds = new Box3();
  #failed = new WeakSet<SplatEngine>();
  /** Promises of clouds and claims that have their handlers, so that each is handled once. */
  readonly #handled = new WeakSet<Promise<unknown>>();
  readonly #reported = new Set<string>();
  readonly #clamped = new Set<string>();
  #data: SplatData | null = null;
  /** The splats on the screen, which stay there until others take their place. */
  #drawn: SplatData | null = null;
  #reveal: RevealAnimation | RevealOptions | null = null;
  /** Time of the first frame that shows how the cloud appears. */
  #revealBeganMs: number | null = null;
  #layer: SplatLayer | null = null;
  #isAnnounced = false;
  #choice: AccuracyChoice | null = null;
  /** What the bounds were computed from. */
  #bounded: { instances: SplatInstances | null; version?: number; count?: number } = { instances: null };
  /** Of the splats on the screen, on each engine. */
  readonly #followers = new Map<CloudStream, StreamFollower>();

  constructor(data: SplatData | null = null) {
    super();
    this.data = data;
    this.addEventListener('removed', () => this.#layer && this.leave(this.#layer));
  }

  /**
   * The splats to draw. Replace them at any time: the old ones stay on the screen until the new
   * ones are drawn, which takes their upload and shaders for them, or until the GPU has no memory
   * for both. Then their GPU copy is freed with its last user. Null: nothing. Draws no preview of a
   * load that has failed.
   */
  get data(): SplatData | null {
    return this.#data;
  }

  set data(data: SplatData | null) {
    const before = this.#data;
    if (data === before) return;
    // The successor of a preview goes on appearing.
    if (!before?.isPreview) this.#revealBeganMs = null;
    this.#data = data;
    this.#isAnnounced = false;
    if (before !== this.#drawn) before?.release(this);
    if (!data) this.#replaceDrawn(null);
    this.#forgetErrors();
    this.computeBoundingBox();
    this.requestFrame();
  }

  /**
   * How the cloud appears. Over `durationMs`: once from the first frame after this was set, and again
   * from the first frame with other data, unless that takes the place of a preview. `needsframe`
   * events request the frames that this needs. With a `radius`: as far as that reaches. Null: the
   * cloud appears at once.
   *
   * @throws InvalidArgumentError for an invalid place, width or time of what has a time; the frame
   *   reports others.
   */
  get reveal(): RevealAnimation | RevealOptions | null {
    return this.#reveal;
  }

  set reveal(given: RevealAnimation | RevealOptions | null) {
    this.#reveal = given && isAnimation(given) ? checkedReveal(given) : given;
    this.#revealBeganMs = null;
  }

  /** Computes the bounds of data and instances now; frames do when these change. */
  computeBoundingBox(): void {
    const { instances } = this;
    const bounds = this.#data?.robustBounds.clone() ?? new Box3();
    withBounds(this.geometry, instances ? instances.boundsOf(bounds) : bounds);
    this.#bounded = { instances, version: instances?.version, count: instances?.count };
  }

  /** @internal `opacity` within its range. */
  get drawnOpacity(): number {
    return this.clamped('opacity', this.opacity, 1);
  }

  /**
   * Returns the effects that the cloud has at any time and in any scene.
   *
   * @throws InvalidArgumentError for invalid options.
   */
  protected ownEffects(): readonly EffectUse[] {
    const given = this.#reveal;
    if (!given || isAnimation(given)) return this.effects;
    const { radius, softEdge = 0 } = given;
    const within = (value: number) => this.clamped('reveal', value, Number.POSITIVE_INFINITY);
    return [...this.effects, reveal({ ...given, radius: within(radius), softEdge: within(softEdge) })];
  }

  /**
   * Returns the number in 0…`max` that is nearest to a finite `value`. Warns once of each property
   * that is out of this range; leaves what is no finite number to be refused.
   */
  protected clamped(property: string, value: number, max: number): number {
    if (!Number.isFinite(value) || (value >= 0 && value <= max)) return value;
    const nearest = value < 0 ? 0 : max;
    if (!this.#clamped.has(property)) {
      this.#clamped.add(property);
      console.warn(
        `${property} of a cloud of splats holds ${value}, beyond 0…${max}. It counts as ${nearest}, and so will others.`,
      );
    }
    return nearest;
  }

  override updateMatrixWorld(force?: boolean): void {
    const { instances } = this;
    const { version, count } = instances ?? {};
    const { instances: before, version: versionBefore, count: countBefore } = this.#bounded;
    if (instances !== before || version !== versionBefore || count !== countBefore) this.computeBoundingBox();
    super.updateMatrixWorld(force);
    this.worldBounds.copy(this.geometry.boundingBox!).applyMatrix4(this.matrixWorld);
    const root = rootOf(this);
    if (root === this) return;
    if (this.#layer?.parent !== root || this.#layer.renderOrder !== this.renderOrder) {
      this.#layer?.drop(this);
      this.#layer = layerOf(root, this.renderOrder);
    }
    this.#layer.place(this);
  }

  /**
   * Adds where the ray meets splats that are drawn, unless all of them along it have less than 30 %
   * opacity: at the depth of the splat that contributes most, as `pick` finds it, if
   * `raycaster.camera` is the camera that the ray comes from (`setFromCamera`). Of more than half a
   * million splats, neighbours count as one. Splats that the ray begins inside of are left out.
   * Misses until `data.prepareRays()` is done, which the first ray begins; and misses previews.
   */
  override raycast(raycaster: Raycaster, intersects: Intersection[]): void {
    this.#data?.raycast(this, raycaster, intersects);
  }

  /**
   * Returns the splat that contributes most to a pixel of the frame that `renderer` drew last from
   * `camera`. Null if it belongs to another cloud or a preview, if there is none, and before the
   * first frame with these data.
   *
   * @param xPx, yPx physical pixels from the canvas's top left.
   */
  async pick(renderer: WebGPURenderer, camera: Camera, xPx: number, yPx: number): Promise<SplatHit | null> {
    const hit = await this.#layer?.pick(renderer, camera, xPx, yPx);
    if (hit?.object !== this || this.#drawn !== this.#data) return null;
    return { object: this, ...hitOf(hit) };
  }

  /**
   * Measures again which settings meet the target of the frame that drew this cloud last. The
   * settings in use stay until then, and if measuring fails. All clouds of the frame dispatch an
   * `accuracychosen` event.
   *
   * @throws InvalidArgumentError if the cloud has not been drawn, or not under a target; the
   *   signal's reason; an AbortError if a later measurement takes over; DestroyedError.
   */
  async chooseAccuracy(options?: ChooseAccuracyOptions): Promise<AccuracyChoice> {
    const view = this.#layer?.views.latestWith(this);
    if (view) return view.embedded.chooseAccuracy(options);
    const message = 'The cloud has not been drawn yet.';
    throw new InvalidArgumentError('chooseAccuracy', message);
  }

  override copy(source: this, recursive?: boolean): this {
    super.copy(source, recursive);
    const { data, opacity, shDegree, effects, fog, reveal, depthWrite, accuracy, detail, instances } = source;
    const drawn = { opacity, shDegree, effects, fog, reveal, depthWrite, accuracy, detail, instances };
    return Object.assign(this, { data, ...drawn });
  }

  /**
   * Removes the cloud from the screen and releases its GPU copy, which goes with its last user.
   * Drawing uploads it again.
   */
  override dispose(): void {
    if (this.#layer) this.leave(this.#layer);
    this.#data?.release(this);
    this.#replaceDrawn(null);
    this.#forgetErrors();
    // three's objects have no `dispose` before 0.187.
    super.dispose?.();
  }

  /** @internal The cloud is no longer in the scene of `layer`. */
  leave(layer: CloudLayer): void {
    if (this.#layer === layer) this.#layer = null;
    layer.drop(this);
  }

  /**
   * @internal Returns the cloud on `engine`, and brings it there if necessary; null without data,
   *   as long as these are being read again, and if that, the upload or the load of a preview
   *   fails.
   */
  uploadedTo(engine: SplatEngine): SplatCloud | null {
    const data = this.#data;
    if (!data || this.#failed.has(engine)) return null;
    const fail = (error: Error) => {
      if (this.#data !== data || error.name === 'AbortError') return;
      // There may be room for these once those on the screen are gone.
      if (error instanceof GpuLimitError && this.#drawn && this.#drawn !== data) {
        this.#replaceDrawn(null);
        this.requestFrame();
        return;
      }
      this.#failed.add(engine);
      // The renderer reports a lost device.
      if (!(error instanceof DestroyedError || this.tell(error))) console.error(error);
    };
    try {
      const cloud = data.acquire(engine, this);
      const there: Promise<unknown> = cloud instanceof Promise ? cloud : cloud.uploaded;
      if (!this.#handled.has(there)) there.then((loaded) => loaded && this.requestFrame(), fail);
      this.#handled.add(there);
      // A preview ends with the load that it is of.
      return cloud instanceof Promise || cloud.isDestroyed ? null : cloud;
    } catch (error) {
      fail(error as Error);
    }
    return null;
  }

  /**
   * @internal Makes the cloud on `engine`, which has been uploaded, hold the planes that `settings`
   *   need; null: its view claims them. Reports a failure, and requests a frame if other planes
   *   change the image.
   */
  hold(engine: SplatEngine, settings: AccuracySettings | null): void {
    const data = this.#data!;
    const met = data.hold(engine, this, settings);
    if (!met || !settings || this.#handled.has(met)) return;
    this.#handled.add(met);
    const cloud = this.uploadedTo(engine)!;
    const before = cloud.pagesFor(settings);
    met.then(
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

  /** @internal Passes an error to the listener, once per text; returns false without a listener. */
  tell(error: unknown): boolean {
    if (!this.onError) return false;
    const text = String(error);
    if (!this.#reported.has(text)) {
      this.#reported.add(text);
      // three may be in the middle of its frame.
      queueMicrotask(() => callListener(this.onError, error as Error));
    }
    return true;
  }

  /** @internal */
  requestFrame(): void {
    dispatch(this, { type: 'needsframe' });
  }

  /**
   * @internal Returns the effects for a frame of `scene` at `nowMs`; null while code for them is
   *   loaded.
   *
   * @throws InvalidArgumentError for invalid options.
   */
  effectsAt(nowMs: number, scene: Scene, camera: Camera): readonly EffectUse[] | null {
    const progress = this.#revealedAt(nowMs);
    const isInFog = this.fog && (scene.fog || (scene as { fogNode?: object | null }).fogNode);
    const own = this.ownEffects();
    if (progress >= 1 && !isInFog && !isInClippingGroup(this)) return own;
    if (later) return later.sceneEffects(this, own, progress, scene, camera);
    import('./scene-effects.ts').then(
      (loaded) => {
        later = loaded;
        this.requestFrame();
      },
      (error) => this.tell(error),
    );
    return null;
  }

  /**
   * @internal Called while a frame with the current data is recorded.
   *
   * @param drawn the effects of that frame; others while shaders for the current ones compile.
   * @param stream of its cloud; null where all splats are there.
   */
  announceDrawn(nowMs: number, drawn: readonly SplatEffect[], stream: CloudStream | null = null): void {
    const data = this.#data!;
    this.#replaceDrawn(data);
    if (!this.#isAnnounced && !data.isPreview) {
      this.#isAnnounced = true;
      this.#announce('firstframe');
      if (!stream) this.#announce('complete');
    }
    if (stream) this.#followerOf(stream).drawn();
    // Otherwise shaders compile: a frame is asked for when they are ready.
    if (this.#revealedAt(nowMs) >= 1 || !drawn.includes(reveal.effect)) return;
    this.#revealBeganMs ??= nowMs;
    queueMicrotask(() => this.requestFrame());
  }

  /** Dispatches an event once three, which is in the middle of its frame, is done with that. */
  #announce(type: 'firstframe' | 'complete'): void {
    queueMicrotask(() => dispatch(this, { type }));
  }

  #followerOf(stream: CloudStream): StreamFollower {
    const known = this.#followers.get(stream);
    if (known) return known;
    const follower = new StreamFollower(stream, {
      requestFrame: () => queueMicrotask(() => this.requestFrame()),
      onComplete: () => this.#announce('complete'),
      onError: (error: SplatsStreamError) =>
        queueMicrotask(() => {
          if (this.onError) callListener(this.onError, error);
          else console.warn(error);
        }),
    });
    this.#followers.set(stream, follower);
    return follower;
  }

  /**
   * Part of the time of appearing that has passed: 0 before its first frame, 1 or more where all is
   * shown.
   */
  #revealedAt(nowMs: number): number {
    const given = this.#reveal;
    if (!given || !isAnimation(given)) return 1;
    return (nowMs - (this.#revealBeganMs ?? nowMs)) / given.durationMs;
  }

  /** @internal Called with the settings chosen for a frame with this cloud. */
  announceAccuracy(choice: AccuracyChoice): void {
    // Several views of a scene share a choice.
    if (choice === this.#choice) return;
    this.#choice = choice;
    dispatch(this, { type: 'accuracychosen', choice });
  }

  /** Lets go of the splats on the screen, unless they are `data`, which take their place. */
  #replaceDrawn(data: SplatData | null): void {
    if (this.#drawn === data) return;
    for (const follower of this.#followers.values()) follower.end();
    this.#followers.clear();
    this.#drawn?.release(this);
    this.#drawn = data;
  }

  #forgetErrors(): void {
    this.#failed = new WeakSet();
    this.#reported.clear();
  }
}

function isInClippingGroup(object: Object3D): boolean {
  for (let at: Object3D | null = object; at; at = at.parent)
    if ((at as { isClippingGroup?: boolean }).isClippingGroup) return true;
  return false;
}
