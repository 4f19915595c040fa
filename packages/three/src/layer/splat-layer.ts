import {
  type AccuracySettings,
  DestroyedError,
  type EmbeddedFrameRequest,
  isAccuracyTarget,
  type PossibleAccuracy,
  ShaderError,
  type SplatEngine,
  type SplatPick,
} from '@websplatter/core';
import type { EffectUse } from '@websplatter/core/effects';
import {
  type ArrayCamera,
  Box3,
  type Camera,
  type Material,
  Object3D,
  type Object3DJSON,
  type Scene,
  Vector3,
  type WebGPURenderer,
} from 'three/webgpu';
import { SplatsPrecisionError } from '../errors.ts';
import { adoptRenderer, findSplatEngine } from '../renderer/adopt-renderer.ts';
import { paceAnimationLoop } from '../renderer/loop-pace.ts';
import { reportStageTimings } from '../renderer/stage-timings.ts';
import { type OpenPass, openPass, type PassPart, PassRefusal } from '../renderer/three-bridge.ts';
import type { DrawnCloud, LayerCloud } from './layer-cloud.ts';
import { ColorLayerMaterial } from './layer-material.ts';
import type { LayerOutputs } from './layer-outputs.ts';
import { accuracyOf, effectsIn, instanceOf, prepareView } from './layer-request.ts';
import type { LayerShadows } from './layer-shadows.ts';
import { type LayerView, LayerViews } from './layer-view.ts';
import { ViewportTriangle } from './viewport-triangle.ts';

/** Loaded when an ArrayCamera draws. */
let openArrayPass: typeof import('./several-cameras.ts').openArrayPass | null = null;

/** In `userData` of the empty object that stands for a layer in JSON. */
const PLACEHOLDER = 'isSplatLayer';

/**
 * Returns the layer of this order in the scene of root `root`; adds one if there is none.
 *
 * @param alone the only cloud of the layer; null for the layer of all other clouds.
 */
export function layerOf(root: Object3D, renderOrder: number, alone: LayerCloud | null): SplatLayer {
  const found = layersIn(root).find((layer) => layer.renderOrder === renderOrder && layer.alone === alone);
  const layer = found ?? new SplatLayer(renderOrder, alone);
  if (!found) {
    root.add(layer);
    // Deferred: three may be traversing the scene.
    queueMicrotask(() => root.remove(...root.children.filter(({ userData }) => userData[PLACEHOLDER])));
  }
  return layer;
}

/** Returns the layers of the scene that `object` is in, the one that is drawn last first. */
export function layersAround(object: Object3D): SplatLayer[] {
  return layersIn(rootOf(object)).sort((a, b) => b.renderOrder - a.renderOrder);
}

function layersIn(root: Object3D): SplatLayer[] {
  return root.children.filter((child) => child instanceof SplatLayer);
}

/** Returns the object at the top of the tree of `object`; itself if it has no parent. */
export function rootOf(object: Object3D): Object3D {
  let root = object;
  while (root.parent) root = root.parent;
  return root;
}

/**
 * Draws all clouds of a scene that have the same `renderOrder`, sorted together, as one of three's
 * transparent objects; a cloud that fades has a layer of its own. Before three draws this object, the layer interrupts the pass to draw the
 * splats; the object itself is a triangle over the viewport that shows their image.
 */
export class SplatLayer extends ViewportTriangle<ColorLayerMaterial> {
  /** The cloud that fades in this layer; null for a layer of clouds that do not fade. */
  readonly alone: LayerCloud | null;
  readonly #clouds = new Set<LayerCloud>();
  /** @internal */
  readonly views = new LayerViews();
  readonly #depthTriangle: ViewportTriangle<Material>;
  /** Depth and further outputs of the layer; null until they are needed and their code is loaded. */
  #outputs: LayerOutputs | null = null;
  /** Shadows of the clouds; null until a cloud has some and their code is loaded. */
  #shadows: LayerShadows | null = null;
  readonly #loading = new Set<string>();
  readonly #reported = new Set<string>();
  readonly #precisionErrors = new Map<string, SplatsPrecisionError>();
  /** Renderers whose engine is awaited to request a frame. */
  readonly #awaited = new WeakSet<object>();

  constructor(renderOrder: number, alone: LayerCloud | null = null) {
    super(new ColorLayerMaterial(), renderOrder);
    this.alone = alone;
    this.name = 'splats';
    // Both have the same place and successive ids, so three draws the second directly after the
    // first, sorted or not.
    this.#depthTriangle = new ViewportTriangle<Material>(this.material, renderOrder);
    this.#depthTriangle.matrixWorld = this.matrixWorld;
    this.#depthTriangle.visible = false;
    this.add(this.#depthTriangle);
  }

  /** Returns a layer for a copy of the scene. It leaves the copy unless cloned clouds use it. */
  override clone(): this {
    return new SplatLayer(this.renderOrder) as this;
  }

  /**
   * Returns an empty object: JSON of a scene has one for each child. The next layer in a scene that
   * is restored from it takes its place.
   */
  override toJSON(meta?: Parameters<Object3D['toJSON']>[0]): Object3DJSON {
    const placeholder = new Object3D();
    placeholder.name = this.name;
    placeholder.userData[PLACEHOLDER] = true;
    return placeholder.toJSON(meta);
  }

  /** Follows no parent; leaves a scene without clouds of its own, such as a copy of another. */
  override updateMatrixWorld(): void {
    if (this.#clouds.size === 0) this.#leaveUnused();
  }

  /** Adds `cloud`, or updates the layer for its new place. */
  place(cloud: LayerCloud): void {
    this.#clouds.add(cloud);
    this.#arrange();
  }

  /** Stops drawing `cloud`. The layer leaves the scene and frees its memory after the last. */
  drop(cloud: LayerCloud): void {
    if (!this.#clouds.delete(cloud)) return;
    this.#arrange();
    if (this.#clouds.size === 0) this.#leaveUnused();
  }

  /** Deferred: three may be traversing the scene or drawing this object; a cloud may come back. */
  #leaveUnused(): void {
    queueMicrotask(() => {
      if (this.#clouds.size > 0) return;
      this.removeFromParent();
      this.#free();
    });
  }

  /** Returns the splat at a pixel of the latest frame from `camera`, or null. */
  async pick(
    renderer: WebGPURenderer,
    camera: Camera,
    xPx: number,
    yPx: number,
  ): Promise<(SplatPick & { readonly object: LayerCloud }) | null> {
    const view = this.views.latest(renderer, camera);
    if (!view) return null;
    const { clouds } = view;
    const pick = await view.embedded.pick(xPx - view.xPx, yPx - view.yPx);
    return pick && { ...pick, object: [...clouds.keys()][pick.cloudIndex] };
  }

  /** Frees the layer's GPU memory; the layer may be drawn again. */
  #free(): void {
    this.views.destroyAll();
    this.material.dispose();
    this.#outputs?.dispose();
    this.#shadows?.dispose();
    this.geometry.dispose();
    this.#depthTriangle.geometry.dispose();
  }

  /**
   * Sets the layer's place among three's transparent objects, whether it writes depth, and whether it
   * has a part in shadows.
   */
  #arrange(): void {
    const box = new Box3();
    let depthWrite = false;
    let hasShadows = false;
    for (const cloud of this.#clouds) {
      box.union(cloud.worldBounds);
      depthWrite ||= cloud.depthWrite;
      hasShadows ||= cloud.castShadow || cloud.receiveShadow;
    }
    if (!box.isEmpty()) this.matrixWorld.setPosition(box.getCenter(new Vector3()));
    if (depthWrite) this.#loadOutputs();
    this.#depthTriangle.visible = depthWrite && !!this.#outputs;
    if (hasShadows)
      this.#load(
        'shadows',
        () => import('./layer-shadows.ts'),
        ({ LayerShadows }) => {
          this.#shadows = new LayerShadows(this);
        },
      );
    this.#shadows?.arrange();
  }

  override onBeforeRender(renderer: object, scene: Scene, camera: Camera): void {
    // Drawn below, once the material has an image per camera: three cannot draw it otherwise.
    this.count = this.#depthTriangle.count = 0;
    const open = (camera as ArrayCamera).isArrayCamera ? openArrayPass : openPass;
    if (!open)
      this.#load(
        'cameras',
        () => import('./several-cameras.ts'),
        (loaded) => {
          openArrayPass = loaded.openArrayPass;
        },
      );
    // Passes with an override material are about meshes: shadows, normals, depth.
    if (!open || scene.overrideMaterial) return;
    try {
      const engine = findSplatEngine(renderer);
      if (!engine) {
        this.#awaitEngine(renderer);
        return;
      }
      const pass = open(renderer as WebGPURenderer, scene, camera as ArrayCamera, this);
      if (pass) this.#drawInto(pass, renderer as WebGPURenderer, engine, scene);
    } catch (error) {
      this.reportDrawing(error);
      // A WebGLRenderer cannot draw splats, nor the layer's material.
      if ((renderer as { isWebGLRenderer?: boolean }).isWebGLRenderer) throw error;
    }
  }

  /** Requests a frame when `renderer` has its engine. */
  #awaitEngine(renderer: object): void {
    if (this.#awaited.has(renderer)) return;
    this.#awaited.add(renderer);
    adoptRenderer(renderer).then(
      () => this.requestFrame(),
      (error) => this.reportDrawing(error),
    );
  }

  /** @internal */
  requestFrame(): void {
    for (const cloud of this.#clouds) cloud.requestFrame();
  }

  #drawInto(pass: OpenPass, renderer: WebGPURenderer, engine: SplatEngine, scene: Scene): void {
    const nowMs = performance.now();
    const shown = this.shownClouds();
    if (shown.length === 0) return;
    const place = { renderer, scene, nowMs, shadows: this.#shadows?.effectIn(renderer, scene) };
    const views = pass.parts.map((part) => this.#prepareView(part, pass, place, engine, shown));
    if (!views.some(Boolean)) return;
    paceAnimationLoop(renderer, engine.device.queue);
    pass.interrupt((part, encoder) => {
      const view = views[part];
      if (!view) return;
      const { embedded, clouds } = view;
      const { host } = pass.parts[part];
      view.show(encoder ? embedded.draw(encoder, host) : embedded.makeImage(host), host);
      if (encoder) this.#outputs?.show(view, renderer, pass, part, encoder);
      [...clouds.keys()].forEach((object, i) => {
        // The view may have drawn its last frame instead.
        const shape = embedded.shape!.clouds[i];
        if (shape && object.uploadedTo(engine) === shape.cloud)
          object.announceDrawn(
            nowMs,
            shape.effects.linked.map(({ effect }) => effect),
            shape.cloud.stream,
          );
      });
    });
    this.material.show(views, 'color');
    this.#outputs?.depthMaterial.show(views, 'depth');
    this.#depthTriangle.count = 1;
    if (pass.parts.some(({ host }) => !host.writesColor)) this.count = 1;
  }

  /** Has a view find and sort the splats that its camera sees; null if there is nothing to draw. */
  #prepareView(
    part: PassPart,
    pass: OpenPass,
    place: PassPlace,
    engine: SplatEngine,
    shown: readonly LayerCloud[],
  ): LayerView | null {
    const { renderer, shadows } = place;
    const view: LayerView = this.views.use(renderer, part.camera, pass.target, () => {
      const embedded = engine.createEmbeddedView();
      embedded.onReady = () => this.requestFrame();
      embedded.onFault = (error, clouds) => {
        const concerned = [...this.#clouds].filter((cloud) => clouds.includes(cloud.uploadedTo(engine)!));
        this.#report(error, concerned);
      };
      embedded.onAccuracyChosen = (choice) => {
        for (const cloud of view.clouds.keys()) cloud.announceAccuracy(choice);
      };
      embedded.onStatistics = (statistics) => reportStageTimings(renderer, statistics);
      return embedded;
    });
    if (renderer.getMRT()) this.#loadOutputs();
    // Keep the present image until the outputs are loaded.
    if (this.#loading.has('outputs') && !this.#outputs && view.clouds.size === 0) return null;
    const wantedOf = (object: LayerCloud) => {
      const effects = effectsIn({ ...place, camera: part.camera, object });
      if (object.receiveShadow) {
        // Their code is on its way.
        if (!this.#shadows) return null;
        if (shadows && !effects?.some(({ effect }) => effect === shadows.effect)) effects?.push(shadows);
      }
      return instanceOf(object, engine, effects);
    };
    const isReady = (clouds: Clouds, other?: Partial<EmbeddedFrameRequest>) =>
      prepareView(view, pass, part, clouds, { fade: this.alone?.drawnFade, ...other });
    /** Returns the clouds that can be drawn now. `refused` clouds stay as they were in the last frame. */
    const prepare = (refused: readonly LayerCloud[] = []) => {
      const accepted = shown.filter((object) => !refused.includes(object));
      const { settings, notices } = planesFor(accepted, engine);
      for (const notice of notices) {
        // One error for each notice: every frame has the same ones.
        const error = this.#precisionErrors.get(notice) ?? new SplatsPrecisionError(new Error(notice));
        this.#precisionErrors.set(notice, error);
        this.#report(error);
      }
      const clouds: Clouds = new Map();
      // The clouds of the last frame, which stay while others are uploaded and shaders for them compile.
      const lasting: Clouds = new Map();
      for (const object of shown) {
        if (!object.layers.test(part.camera.layers)) continue;
        const wanted = refused.includes(object) ? null : wantedOf(object);
        if (wanted) object.hold(engine, settings);
        const last = view.clouds.get(object);
        const before = last?.cloud === wanted?.cloud ? wanted : last;
        if (object.data && before && !before.cloud.isDestroyed) lasting.set(object, before);
        const drawn = wanted ?? lasting.get(object);
        if (drawn) clouds.set(object, drawn);
      }
      // Keeps the picture of the layer that the cloud leaves, while the shader of the fade compiles.
      if (this.alone?.isDrawn && view.clouds.size === 0) isReady(clouds, { fade: 1 });
      return isReady(clouds) ? clouds : isReady(lasting) ? lasting : null;
    };
    const isRefused = (object: LayerCloud) => {
      try {
        const wanted = wantedOf(object);
        // Without pixels, options are checked and nothing is prepared.
        if (wanted) isReady(new Map([[object, wanted]]), { widthPx: 0 });
        return false;
      } catch (error) {
        this.#report(error, [object]);
        return true;
      }
    };
    let drawn: Clouds | null;
    try {
      drawn = prepare();
    } catch (error) {
      const refused = shown.filter(isRefused);
      if (refused.length === 0) throw error;
      drawn = prepare(refused);
    }
    if (drawn) view.clouds = drawn;
    return drawn && view;
  }

  #loadOutputs(): void {
    this.#load(
      'outputs',
      () => import('./layer-outputs.ts'),
      ({ LayerOutputs }) => {
        this.material.dispose();
        this.#outputs = new LayerOutputs();
        this.material = this.#outputs.colorMaterial;
        this.#depthTriangle.material = this.#outputs.depthMaterial;
      },
    );
  }

  /** Fetches code that few layers need, unless it is on its way; tries again after a failure. */
  #load<Code>(name: string, fetchCode: () => Promise<Code>, use: (code: Code) => void): void {
    if (this.#loading.has(name)) return;
    this.#loading.add(name);
    fetchCode().then(
      (code) => {
        use(code);
        this.#arrange();
        this.requestFrame();
      },
      (error) => {
        this.#loading.delete(name);
        this.#report(error);
      },
    );
  }

  /** @internal Has the next frame draw all shadow maps: splats in them change without their user. */
  redrawShadowMaps(): void {
    this.#shadows?.redrawMaps();
  }

  /** @internal All clouds of the layer, also invisible ones. */
  get clouds(): ReadonlySet<LayerCloud> {
    return this.#clouds;
  }

  /** @internal Returns the visible clouds of all `layers`: `layers` are tested per camera. */
  shownClouds(): LayerCloud[] {
    for (const object of [...this.#clouds]) if (rootOf(object) !== this.parent) object.leave(this);
    return [...this.#clouds].filter(
      (object) => object.drawnOpacity !== 0 && object.drawnFade !== 0 && isShown(object),
    );
  }

  /** Reports an error of drawing, except a lost device, which the renderer reports. */
  reportDrawing(error: unknown): void {
    if (error instanceof PassRefusal)
      import('../renderer/pass-errors.ts').then(
        ({ passError }) => this.#report(passError(error.reason)),
        (lost) => this.#report(lost),
      );
    else if (!(error instanceof DestroyedError)) this.#report(error);
  }

  /**
   * Passes an error once to each of the `clouds` that cannot be drawn because of it, and without listeners
   * to the console. Errors of shaders go there, too, for their authors. Does not throw: three would abandon
   * this frame and every later one.
   */
  #report(error: unknown, clouds: Iterable<LayerCloud> = this.#clouds): void {
    const listening = [...clouds].filter((cloud) => cloud.tell(error));
    const text = String(error);
    if ((listening.length > 0 && !(error instanceof ShaderError)) || this.#reported.has(text)) return;
    this.#reported.add(text);
    console.error(error);
  }
}

/** Clouds in the scene, and how a frame has them. */
type Clouds = Map<LayerCloud, DrawnCloud>;

/** Where and when the cameras of a pass draw. */
interface PassPlace {
  readonly renderer: WebGPURenderer;
  readonly scene: Scene;
  readonly nowMs: number;
  /** Null or undefined if no light has shadows. */
  readonly shadows: EffectUse | null | undefined;
}

/** Whether `object` and all of its ancestors are visible. */
export function isShown(object: Object3D): boolean {
  for (let at: Object3D | null = object; at; at = at.parent) if (!at.visible) return false;
  return true;
}

/**
 * Returns the settings whose planes each drawn cloud must hold. They follow from all visible clouds,
 * not only from clouds in the camera's view; otherwise cameras with different clouds would claim
 * different planes in turn. Null under a target: the view itself claims planes for its chosen
 * settings. `notices` list settings that the device does not support.
 */
function planesFor(
  shown: Iterable<LayerCloud>,
  engine: SplatEngine,
): Pick<PossibleAccuracy, 'notices'> & { readonly settings: AccuracySettings | null } {
  const accuracy = accuracyOf(shown);
  const isTarget = accuracy !== undefined && isAccuracyTarget(accuracy);
  return isTarget ? { settings: null, notices: [] } : engine.resolveAccuracy(accuracy);
}
