// Code for shadows that splats cast and receive, as few scenes have.
import { isAccuracyTarget, type SplatEngine } from '@websplatter/core';
import type { EffectUse } from '@websplatter/core/effects';
import type { Camera, Object3D, PointLight, Scene, WebGPURenderer } from 'three/webgpu';
import { findSplatEngine } from '../renderer/adopt-renderer.ts';
import { type OpenPass, openPass } from '../renderer/three-bridge.ts';
import { SceneShadows } from '../scene/scene-shadows.ts';
import { DepthLayerMaterial } from './depth-material.ts';
import type { DrawnCloud, LayerCloud } from './layer-cloud.ts';
import { accuracyOf, effectsIn, instanceOf, prepareView } from './layer-request.ts';
import { LayerViews } from './layer-view.ts';
import { ViewportTriangle } from './viewport-triangle.ts';

/** The part of a layer that shadows use. */
export interface ShadowedLayer extends Object3D {
  readonly alone: LayerCloud | null;
  readonly clouds: ReadonlySet<LayerCloud>;
  shownClouds(): readonly LayerCloud[];
  requestFrame(): void;
  reportDrawing(error: unknown): void;
}

/** The part of a layer's clouds in shadows, that of one layer. */
export class LayerShadows {
  readonly #layer: ShadowedLayer;
  readonly #caster: ShadowCaster;
  readonly #received = new SceneShadows();
  /** Whether shadow maps may lack what the clouds show now. */
  #areMapsOld = false;

  constructor(layer: ShadowedLayer) {
    this.#layer = layer;
    this.#caster = new ShadowCaster(layer);
    for (const child of [this.#caster, this.#received.lit]) {
      child.matrixWorld = layer.matrixWorld;
      child.visible = false;
      layer.add(child);
    }
  }

  /** Has the next frame draw shadow maps, also those that three keeps (`shadow.autoUpdate`). */
  redrawMaps(): void {
    this.#areMapsOld = true;
  }

  /**
   * Shows the objects that the layer's clouds need; frees the memory of casting when none casts.
   * Called before each frame.
   */
  arrange(): void {
    const clouds = [...this.#layer.clouds];
    this.#show(
      this.#caster,
      clouds.some(({ castShadow }) => castShadow),
    );
    if (!this.#caster.visible) this.#caster.views.destroyAll();
    this.#show(
      this.#received.lit,
      clouds.some(({ receiveShadow }) => receiveShadow),
    );
    const { parent } = this.#layer;
    if (!this.#areMapsOld || !parent) return;
    this.#areMapsOld = false;
    // Hidden lights, too: they keep their maps until they are seen again. Of lights whose maps have no
    // splats, some have no shadow, and point lights have six faces to draw.
    parent.traverse((object) => {
      const { castShadow, shadow, isPointLight } = object as PointLight;
      if (castShadow && shadow && !isPointLight) shadow.needsUpdate = true;
    });
  }

  /** Maps drawn so far lack an object that comes, and have one that goes. */
  #show(object: Object3D, isShown: boolean): void {
    if (object.visible !== isShown) this.redrawMaps();
    object.visible = isShown;
  }

  /** Returns the effect that shadows have on clouds that receive them; null without any. */
  effectIn(renderer: WebGPURenderer, scene: Scene): EffectUse | null {
    return this.#received.effectIn(renderer, scene);
  }

  dispose(): void {
    this.#caster.material.dispose();
    this.#caster.geometry.dispose();
    this.#caster.views.destroyAll();
    this.#received.dispose();
  }
}

/**
 * Draws the clouds of a layer that cast shadows into three's shadow maps: their depth as the light's
 * camera sees it, interrupting the pass as the layer does.
 */
class ShadowCaster extends ViewportTriangle<DepthLayerMaterial> {
  readonly views = new LayerViews();
  readonly #layer: ShadowedLayer;

  constructor(layer: ShadowedLayer) {
    super(new DepthLayerMaterial(), layer.renderOrder);
    this.#layer = layer;
    this.count = 0;
    this.castShadow = true;
  }

  override onBeforeShadow(renderer: unknown, _object: unknown, camera: Camera): void {
    try {
      const engine = findSplatEngine(renderer as object);
      // The layer awaits it.
      if (!engine) return;
      const scene = this.#layer.parent as Scene;
      const pass = openPass(renderer as WebGPURenderer, scene, camera, this);
      // The six faces of a point light would take a sort each.
      if (pass?.parts[0].host.depth?.depthOrArrayLayers !== 1) return;
      if (this.#drawInto(pass, renderer as WebGPURenderer, engine, scene)) this.count = 1;
    } catch (error) {
      this.#layer.reportDrawing(error);
    }
  }

  override onAfterShadow(): void {
    this.count = 0;
  }

  /** Returns whether there is depth to show. */
  #drawInto(pass: OpenPass, renderer: WebGPURenderer, engine: SplatEngine, scene: Scene): boolean {
    const { camera, host } = pass.parts[0];
    const view = this.views.use(renderer, camera, pass.target, () => {
      const embedded = engine.createEmbeddedView();
      embedded.onReady = () => this.#layer.requestFrame();
      return embedded;
    });
    const casting = this.#layer
      .shownClouds()
      .filter((cloud) => cloud.castShadow && cloud.layers.test(camera.layers));
    const nowMs = performance.now();
    const drawn = new Map<LayerCloud, DrawnCloud>();
    for (const object of casting) {
      // Nobody sees the colours.
      const effects = effectsIn({ renderer, scene, camera, object, nowMs })?.filter(
        ({ hooks }) => hooks.splat !== undefined || hooks.opacity !== undefined,
      );
      const instance = instanceOf(object, engine, effects);
      if (instance) drawn.set(object, { ...instance, shDegree: 0 });
    }
    const accuracy = accuracyOf(casting);
    const { embedded } = view;
    const isReady = prepareView(view, pass, pass.parts[0], drawn, {
      // The depth test of this object hides what is behind meshes.
      hasOccluders: false,
      writesDepth: true,
      // A shadow is no outcome to measure.
      accuracy: accuracy && isAccuracyTarget(accuracy) ? undefined : accuracy,
      fade: this.#layer.alone?.drawnFade,
    });
    if (!isReady) return false;
    const { drawnImage } = embedded;
    // three clears the map and draws its meshes anew, which change nothing in this image.
    if (drawnImage) view.show(drawnImage, host);
    else
      pass.interrupt((_part, encoder) => {
        view.show(encoder ? embedded.draw(encoder, host) : embedded.makeImage(host), host);
      });
    this.material.show([view], 'depth');
    return true;
  }
}
