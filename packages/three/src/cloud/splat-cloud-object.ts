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
import { dispatch } from '../dispatch.ts';
import { SplatsPrecisionError, type SplatsStreamError } from '../errors.ts';
import type { CloudLayer } from '../layer/layer-cloud.ts';
import { layerOf, rootOf, type SplatLayer } from '../layer/splat-layer.ts';
import { withBounds } from '../layer/viewport-triangle.ts';
import { checkedReveal, isAnimation, type RevealAnimation } from '../scene/reveal-animation.ts';
import { volumesIn } from '../scene/scene-volumes.ts';
import type { SplatData } from './splat-data.ts';
import type { SplatInstances } from './splat-instances.ts';
import { StreamFollower } from './stream-follower.ts';

/** Code for effects that come from the scene or change with time: loaded when a cloud has some. */
let later: typeof import('../scene/scene-effects.ts') | null = null;

/** The splat that contributes most to a pixel. */
export interface SplatHit {
  readonly object: SplatCloudObject;
  /** Row of the splat in its file or arrays. */
  readonly row: number;
  /** Index of the instance that it belongs to, of an object with `instances`. */
  readonly instanceId?: number;
  /** World space. */
  readonly point: Vector3;
  /** Depth along the camera's line of sight, world units. */
  readonly depthView: number;
  /** The splat's opacity at the pixel, 0…1. */
  readonly alpha: number;
}

/** A place on the page, CSS pixels from the viewport's top left, as events of the DOM have it. */
interface PlaceOnPage {
  readonly clientX: number;
  readonly clientY: number;
}

/** A mouse, pointer or wheel event of the DOM, of React or of react-three-fiber. */
export type PickEvent = PlaceOnPage | { readonly nativeEvent: PlaceOnPage };

/** @internal Returns a pick in three's terms. */
export function hitOf(pick: SplatPick): Omit<SplatHit, 'object'> {
  const { row, instanceIndex, point, depthView, alpha } = pick;
  const hit = { row, point: new Vector3(...point), depthView, alpha };
  return instanceIndex === null ? hit : { ...hit, instanceId: instanceIndex };
}

/** Events of a `SplatCloudObject`, in addition to three's events of every object. */
export interface SplatCloudEventMap extends Object3DEventMap {
  /** The first frame with the current data has been submitted; not dispatched for previews. */
  firstframe: object;
  /**
   * A streamed scene is complete: the submitted frame shows all parts that views need, as far as the
   * budget allows. Dispatched again after each frame that lacked parts, such as after a move of the
   * camera. For scenes that do not stream, dispatched with `firstframe`.
   */
  complete: object;
  /** The next frame will differ without a change of the scene: shaders or data are ready. */
  needsframe: object;
  /** Settings have been chosen for a frame with this cloud, for a renderer's or cloud's target. */
  accuracychosen: { readonly choice: AccuracyChoice };
}

/**
 * A cloud of splats anywhere in a scene. All clouds of a scene with the same `renderOrder` are
 * sorted together, also under different transforms. They are drawn as one transparent object in the
 * middle of their common bounds. Transforms may shear, mirror and scale; `visible` and `layers` work
 * as on meshes. View-dependent colours turn with the rotation of the matrix, its polar factor, as
 * `KHR_gaussian_splatting` defines.
 *
 * `clone()` and `copy()` share data, options and instances; listeners stay with the original.
 * `toJSON()` and three's exporters write name, place, children and `userData`, without splats: keep
 * the file's URL in `userData` to load it again. The scene gets a child named `splats`, which draws
 * all clouds; it has no bounds, meets no rays, and is an empty object in JSON.
 *
 * @example
 * const cloud = new SplatCloudObject(await new SplatLoader().loadAsync('/garden.ply'));
 * cloud.rotation.x = Math.PI;
 * scene.add(cloud);
 */
export class SplatCloudObject extends Object3D<SplatCloudEventMap> {
  override readonly type: string = 'SplatCloudObject';
  readonly isSplatCloudObject = true;
  /**
   * Multiplies every splat's opacity, 0…1. Clamped, with one warning: springs overshoot. Surfaces of
   * many splats stay nearly opaque, and show their insides: to fade a cloud, use `fade`.
   */
  opacity = 1;
  /**
   * Share of the cloud's finished picture, 0…1: fades the cloud as a whole. In sRGB's encoding, the
   * image is the mean of the images with and without the cloud, weighted by `fade` and 1 − `fade`. A
   * pixel that lets a share T of the light behind through lets 1 − `fade` · (1 − T) through. Clamped,
   * with one warning.
   *
   * Below 1, the cloud is drawn in a layer of its own: other clouds with the same `renderOrder` are
   * in front of it or behind it as a whole, by the middles of their bounds, and not sorted with it
   * splat by splat. Rays and picks find the cloud as long as `fade` is above 0.
   */
  fade = 1;
  /**
   * Time at which a moving cloud is shown, within `data.timeRange`; null: its first. Others stand still.
   * Set it in each frame to play the scene. Files of frames (`.frames`) are played by `SplatSequence`.
   */
  time: number | null = null;
  /** Colours depend on the view up to this degree of spherical harmonics. */
  shDegree: ShDegree = 3;
  /**
   * Effects from `@websplatter/core/effects` or your own, each at most once: `[tint([1, 0.8,
   * 0.6])]`. Effects cost time.
   */
  effects: readonly EffectUse[] = [];
  /**
   * Whether the scene's fog (Fog, FogExp2) hides splats as it does meshes, unless `effects` has a
   * `fog` of its own. Of a `fogNode`, splats support range and density fog. For any other node they
   * use the scene's `fog`, which meshes ignore then.
   */
  fog = true;
  /**
   * Whether splats write depth where they cover more than half of a pixel: they then hide objects
   * that are drawn later, and effects can read their depth. A pixel gets the median depth: the depth
   * of the splat with which its opacity exceeds one half. Clouds with the same `renderOrder` share
   * one layer: if one writes depth, all do. A cloud that fades counts by its faded opacity.
   */
  depthWrite = false;
  /**
   * Whether splats cast shadows: they write depth into the shadow maps of three's directional and spot
   * lights where they cover more than half of a texel, the median depth. Point lights pass through.
   * Each map takes a second sort of the splats, and about 24 bytes of GPU memory per texel. Needs
   * `renderer.shadowMap.enabled`.
   */
  override castShadow = false;
  /**
   * Whether shadows of three's directional and spot lights darken splats, each as a whole by its
   * centre. Colours stay as they are where no shadow falls. A splat in shadow keeps the share of light
   * that a white mesh would keep: ambient, hemisphere and environment light, and lights without
   * shadows. Shadows of the captured scene are part of the colours. Up to four lights count.
   */
  override receiveShadow = false;
  /**
   * Share of three's light in the cloud's colours, from 0, colours as captured, to 1, lit as a matt mesh
   * of these colours is: by ambient, hemisphere, directional, point and spot lights in their units, and
   * an environment as one of radiance 1. Approximate: normals are the splats' shortest axes, and the
   * light of the capture stays in its colours. Nothing blocks light; with `receiveShadow`, shadows darken
   * the result. More than 31 lights are an error of drawing. Clamped, with one warning.
   */
  relight = 0;
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
   * Level of detail: `full`; or merged splats (blobs) wherever they move light by less than about
   * `{ maxErrorPx: 0.5 }`; or a budget of splats in sight, `{ maxSplats: 1e6 }`. Null: the
   * renderer's detail, an option of `createSplatRenderer` whose default is `full`. All clouds in
   * view with the same `renderOrder` share one frame, which has the finest detail that any of them
   * requests. The old image stays until the clouds' levels are made.
   */
  detail: Detail | null = null;
  /**
   * Instances to draw, relative to this object; null: the cloud is drawn once. Hits of `raycast` and
   * `pick` have an `instanceId`. Instances share all other properties and edits; each has the level
   * of detail of its distance. Temporal effects use the object's motion for all instances. Not
   * supported for streamed scenes.
   */
  instances: SplatInstances | null = null;
  /**
   * Called once for each error of drawing: if the cloud cannot be drawn, if its options are invalid
   * (it is then drawn as before), if the shader of an effect has an error or a texture or buffer of an
   * effect is destroyed (a ShaderError, which also goes to the console, or a DestroyedError; it is then drawn
   * without that effect), or if it is drawn less exactly than requested (a SplatsPrecisionError). Called each time that parts of a streamed scene cannot be fetched (a
   * SplatsStreamError). Without a listener, errors go to the console.
   */
  onError: ((error: Error) => void) | null = null;
  /** A geometry without vertices, whose bounds make Box3.setFromObject include the cloud. */
  readonly geometry = withBounds(new BufferGeometry(), new Box3());
  /** @internal Bounds in world space, as of the last update of the world matrix. */
  readonly worldBounds = new Box3();
  #failed = new WeakSet<SplatEngine>();
  /** Promises of clouds and claims that already have a handler. */
  readonly #handled = new WeakSet<Promise<unknown>>();
  readonly #reported = new Set<string>();
  readonly #clamped = new Set<string>();
  #data: SplatData | null = null;
  /** The splats on the screen, which stay there until others take their place. */
  #drawn: SplatData | null = null;
  #reveal: RevealAnimation | RevealOptions | null = null;
  /** Time of the first frame of the reveal animation, ms; null before. */
  #revealBeganMs: number | null = null;
  #layer: SplatLayer | null = null;
  #isAnnounced = false;
  #choice: AccuracyChoice | null = null;
  /** Inputs of the last bounds: recompute if they change. */
  #bounded: { instances: SplatInstances | null; version?: number; count?: number } = { instances: null };
  /** One follower per engine, for the stream of the splats on the screen. */
  readonly #followers = new Map<CloudStream, StreamFollower>();

  constructor(data: SplatData | null = null) {
    super();
    this.data = data;
    this.addEventListener('removed', () => this.#layer && this.leave(this.#layer));
  }

  /**
   * The splats to draw; null: nothing. Replace them at any time. The old splats stay on the screen
   * until the new ones are uploaded and their shaders compiled, or until the GPU lacks memory for
   * both. Their GPU copy is freed with its last user. Previews of failed loads are not drawn.
   */
  get data(): SplatData | null {
    return this.#data;
  }

  set data(data: SplatData | null) {
    const before = this.#data;
    if (data === before) return;
    // The successor of a preview continues its reveal animation.
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
   * How the cloud appears; null, the default: at once. With `durationMs`, an animation begins with
   * the first frame after this is set, and again with the first frame of other data, unless these
   * replace a preview. `needsframe` events request its frames. With `radius`, splats within the
   * radius are drawn.
   *
   * @throws InvalidArgumentError for an animation with an invalid place, width or time. Invalid
   *   options with a `radius` are reported when a frame is drawn.
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

  /** @internal `fade` within its range. */
  get drawnFade(): number {
    return this.clamped('fade', this.fade, 1);
  }

  /** @internal `relight` within its range. */
  get drawnRelight(): number {
    return this.clamped('relight', this.relight, 1);
  }

  /** @internal Whether splats of it are on the screen. */
  get isDrawn(): boolean {
    return this.#drawn !== null;
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
   * Returns `value` clamped to 0…`max`, and warns once for each property out of range. Returns
   * non-finite values unchanged: later checks refuse them.
   */
  protected clamped(property: string, value: number, max: number): number {
    if (!Number.isFinite(value) || (value >= 0 && value <= max)) return value;
    const nearest = value < 0 ? 0 : max;
    if (!this.#clamped.has(property)) {
      this.#clamped.add(property);
      console.warn(
        `${property} of a cloud of splats holds ${value}, beyond 0…${max}. It is clamped to ${nearest}, as later values will be.`,
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
    const { renderOrder } = this;
    const alone = this.drawnFade === 1 ? null : this;
    const layer = this.#layer;
    if (layer?.parent !== root || layer.renderOrder !== renderOrder || layer.alone !== alone) {
      layer?.drop(this);
      this.#layer = layerOf(root, renderOrder, alone);
    }
    this.#layer!.place(this);
  }

  /**
   * Adds a hit at the depth of the splat that contributes most, if the splats along the ray have a
   * joint opacity of 30 % or more. The hit agrees with `pick` if `raycaster.camera` is the ray's
   * camera (`setFromCamera`). Beyond half a million splats, neighbours are merged. Splats around the
   * ray's origin are ignored. Rays miss previews, and all splats until `data.prepareRays()` is done; the
   * first ray starts it. After edits, and if `time` has changed, the next ray starts another such work;
   * until it is done, rays meet the splats of before.
   */
  override raycast(raycaster: Raycaster, intersects: Intersection[]): void {
    if (this.drawnFade !== 0) this.#data?.raycast(this, raycaster, intersects);
  }

  /**
   * Returns the splat that contributes most to a pixel of the frame that `renderer` drew last from
   * `camera`. Null if no splat covers the pixel, if the splat belongs to another cloud or a preview,
   * and before the first frame with these data.
   *
   * @param xPx, yPx physical pixels from the canvas's top left.
   */
  async pick(renderer: WebGPURenderer, camera: Camera, xPx: number, yPx: number): Promise<SplatHit | null> {
    const hit = await this.#layer?.pick(renderer, camera, xPx, yPx);
    if (hit?.object !== this || this.#drawn !== this.#data) return null;
    return { object: this, ...hitOf(hit) };
  }

  /**
   * Returns the splat that contributes most to the pixel under a pointer: see `pick`. Null before the
   * first frame.
   *
   * @param event of the renderer's canvas, or of an element over it. Scaled canvases and any pixel
   *   ratio are allowed for.
   * @throws InvalidArgumentError for an event without a place.
   * @example
   * canvas.addEventListener('click', async (event) => {
   *   console.log((await cloud.pickAt(event, renderer, camera))?.row);
   * });
   */
  async pickAt(event: PickEvent, renderer: WebGPURenderer, camera: Camera): Promise<SplatHit | null> {
    // Also where there is no canvas to measure, as in tests without a GPU.
    if (!this.#layer?.views.latest(renderer, camera)) return null;
    const { clientX, clientY } = Object('nativeEvent' in event ? event.nativeEvent : event) as PlaceOnPage;
    if (!(Number.isFinite(clientX) && Number.isFinite(clientY))) {
      const message = `The event's place is ${clientX}, ${clientY}; pickAt takes mouse and pointer events, whose clientX and clientY are numbers.`;
      throw new InvalidArgumentError('event', message);
    }
    const { domElement: canvas } = renderer;
    const { left, top, width, height } = canvas.getBoundingClientRect();
    const xPx = ((clientX - left) / width) * canvas.width;
    const yPx = ((clientY - top) / height) * canvas.height;
    // A canvas without a size shows nothing.
    return width > 0 && height > 0 ? this.pick(renderer, camera, xPx, yPx) : null;
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
    const { data, opacity, fade, time, shDegree, effects, fog, reveal, depthWrite } = source;
    const { relight, accuracy, detail, instances } = source;
    const drawn = { opacity, fade, time, shDegree, effects, fog, reveal, depthWrite };
    return Object.assign(this, { data, ...drawn, relight, accuracy, detail, instances });
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
   * @internal Returns the cloud on `engine`, and uploads it if necessary. Null without data, while
   *   data are read again, and if reading, the upload or the load of a preview fails.
   */
  uploadedTo(engine: SplatEngine): SplatCloud | null {
    const data = this.#data;
    if (!data || this.#failed.has(engine)) return null;
    const fail = (error: Error) => {
      if (this.#data !== data || error.name === 'AbortError') return;
      // Free the splats on the screen, and try again: there was no memory for both.
      if (error instanceof GpuLimitError && this.#drawn && this.#drawn !== data) {
        this.#replaceDrawn(null);
        this.requestFrame();
        return;
      }
      this.#failed.add(engine);
      // The renderer reports a lost device.
      if (!(error instanceof DestroyedError)) this.#report(error);
    };
    try {
      const cloud = data.acquire(engine, this);
      const there: Promise<unknown> = cloud instanceof Promise ? cloud : cloud.uploaded;
      if (!this.#handled.has(there)) there.then((loaded) => loaded && this.requestFrame(), fail);
      this.#handled.add(there);
      // A preview is destroyed with the end of its load.
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

  /** Passes an error to the listener or, without one, to the console; once per text. */
  #report(error: unknown): void {
    if (this.tell(error) || this.#reported.has(String(error))) return;
    this.#reported.add(String(error));
    console.error(error);
  }

  /** @internal */
  requestFrame(): void {
    if (this.castShadow) this.#layer?.redrawShadowMaps();
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
    const isOfScene =
      isInFog || this.drawnRelight !== 0 || isInClippingGroup(this) || volumesIn(rootOf(this));
    if (progress >= 1 && !isOfScene) return own;
    if (later) return later.sceneEffects(this, own, progress, scene, camera);
    import('../scene/scene-effects.ts').then(
      (loaded) => {
        later = loaded;
        this.requestFrame();
      },
      (error) => this.#report(error),
    );
    return null;
  }

  /**
   * @internal Called while a frame with the current data is recorded.
   *
   * @param drawn the effects of that frame; others while shaders for the current ones compile.
   * @param stream the cloud's stream; null if all splats are on the GPU.
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
    // If shaders of `reveal` still compile, their end requests a frame.
    if (this.#revealedAt(nowMs) >= 1 || !drawn.includes(reveal.effect)) return;
    this.#revealBeganMs ??= nowMs;
    queueMicrotask(() => this.requestFrame());
  }

  /** Dispatches an event after three's frame, which is being recorded. */
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

  /** Progress of the reveal animation: 0 before its first frame, 1 or more when it is complete. */
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

  /** Releases the splats on the screen, unless they are `data`, and puts `data` in their place. */
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
