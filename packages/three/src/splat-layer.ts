import {
  type AccuracyChoice,
  type AccuracyRequest,
  type ChooseAccuracyOptions,
  type CloudInstance,
  cameraFromMatrices,
  combineAccuracies,
  DestroyedError,
  type Camera as EngineCamera,
  isAccuracyWish,
  type SplatEngine,
  type SplatPick,
} from '@websplatter/core';
import {
  Box3,
  BufferGeometry,
  type Camera,
  Float32BufferAttribute,
  Mesh,
  type Object3D,
  type Scene,
  Sphere,
  Vector3,
  type WebGPURenderer,
} from 'three/webgpu';
import { splatEngineOf } from './create-splat-renderer.ts';
import type { LayerCloud } from './layer-cloud.ts';
import { ColorLayerMaterial, DepthLayerMaterial } from './layer-material.ts';
import { type LayerView, LayerViews } from './layer-view.ts';
import { reportStageTimings } from './stage-timings.ts';
import { type OpenPass, openPass } from './three-bridge.ts';

const layers = new WeakMap<Object3D, SplatLayer>();

/** Returns the layer of the scene whose root is `root`, and adds one if there is none. */
export function layerOf(root: Object3D): SplatLayer {
  let layer = layers.get(root);
  if (!layer) {
    layer = new SplatLayer();
    layers.set(root, layer);
  }
  if (layer.parent !== root) root.add(layer);
  return layer;
}

/** Returns the object at the top of the tree that `object` is in; `object` itself if it has no parent. */
export function rootOf(object: Object3D): Object3D {
  let root = object;
  while (root.parent) root = root.parent;
  return root;
}

/**
 * Draws all clouds of a scene, sorted together, as one of three's transparent objects. Before three draws this object, the
 * layer interrupts the pass to draw the splats; the object itself is a triangle over the viewport that shows their image.
 */
export class SplatLayer extends Mesh<BufferGeometry, ColorLayerMaterial> {
  readonly #clouds = new Set<LayerCloud>();
  readonly #views = new LayerViews();
  readonly #depthMesh = new Mesh(this.geometry, new DepthLayerMaterial());
  readonly #reported = new Set<string>();
  /** View whose image the triangle shows in the current draw; null if it shows nothing. */
  #shown: LayerView | null = null;

  constructor() {
    super(viewportTriangle(), new ColorLayerMaterial());
    this.name = 'splats';
    this.add(this.#depthMesh);
    for (const mesh of [this, this.#depthMesh]) {
      mesh.frustumCulled = false;
      mesh.matrixAutoUpdate = false;
      mesh.matrixWorldAutoUpdate = false;
      // Each cloud has layers of its own, which are tested for each camera.
      mesh.layers.enableAll();
      mesh.raycast = () => {};
    }
    // Both have the same place and successive ids, so three draws the second directly after the first, sorted or not.
    this.#depthMesh.matrixWorld = this.matrixWorld;
    this.onBeforeRender = (renderer, scene, camera) => this.#draw(renderer, scene, camera);
    this.#depthMesh.onBeforeRender = () => this.#showDepth();
  }

  /** Adds `cloud`, or updates the layer for its new place. */
  place(cloud: LayerCloud): void {
    this.#clouds.add(cloud);
    this.#arrange();
  }

  /** Stops drawing `cloud`. After the last cloud, the layer leaves the scene and frees its GPU memory. */
  drop(cloud: LayerCloud): void {
    if (!this.#clouds.delete(cloud)) return;
    this.#arrange();
    // Deferred: three may be traversing the scene or drawing this very object, and the cloud may come back in this task.
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
    const view = this.#views.latest(renderer, camera);
    if (!view) return null;
    const { clouds } = view;
    const pick = await view.embedded.pick(xPx - view.xPx, yPx - view.yPx);
    return pick && { ...pick, object: [...clouds.keys()][pick.cloudIndex] };
  }

  /** Measures the latest frame with `cloud`; null if there is none. */
  chooseAccuracy(cloud: LayerCloud, options?: ChooseAccuracyOptions): Promise<AccuracyChoice> | null {
    return this.#views.latestWith(cloud)?.embedded.chooseAccuracy(options) ?? null;
  }

  /** Frees the layer's GPU memory; the layer may be drawn again. */
  #free(): void {
    this.#views.destroyAll();
    this.material.dispose();
    this.#depthMesh.material.dispose();
    this.geometry.dispose();
  }

  /** Sets the layer's place in three's order of transparent objects, and whether it writes depth. */
  #arrange(): void {
    const box = new Box3();
    let renderOrder: number | null = null;
    let depthWrite = false;
    for (const cloud of this.#clouds) {
      box.union(cloud.worldBounds);
      renderOrder = Math.max(renderOrder ?? cloud.renderOrder, cloud.renderOrder);
      depthWrite ||= cloud.depthWrite;
    }
    if (!box.isEmpty()) this.matrixWorld.setPosition(box.getCenter(new Vector3()));
    this.renderOrder = renderOrder ?? 0;
    this.#depthMesh.renderOrder = this.renderOrder;
    this.#depthMesh.visible = depthWrite;
  }

  #draw(renderer: object, scene: Scene, camera: Camera): void {
    this.#shown = null;
    this.material.showNothing();
    // Passes with an override material are about meshes: shadows, normals, depth.
    if (scene.overrideMaterial) return;
    try {
      const engine = splatEngineOf(renderer);
      const pass = openPass(renderer as WebGPURenderer, scene, camera, this);
      if (pass) this.#drawInto(pass, renderer as WebGPURenderer, engine, scene, camera);
    } catch (error) {
      // The renderer reports a lost device.
      if (!(error instanceof DestroyedError)) this.#report(error);
      // A WebGLRenderer can show nothing of this library, and it does not know the layer's material either.
      if ((renderer as { isWebGLRenderer?: boolean }).isWebGLRenderer) throw error;
    }
  }

  #drawInto(
    pass: OpenPass,
    renderer: WebGPURenderer,
    engine: SplatEngine,
    scene: Scene,
    camera: Camera,
  ): void {
    const nowMs = performance.now();
    const shown = this.#shownClouds();
    const clouds = instancesFor(shown, engine, camera, (object) => object.effectsAt(nowMs, scene, camera));
    if (clouds.size === 0) return;
    holdPlanes(shown, clouds.keys(), engine);
    const view: LayerView = this.#views.use(renderer, camera, pass.target, () => {
      const embedded = engine.createEmbeddedView();
      embedded.onReady = () => {
        for (const cloud of this.#clouds) cloud.requestFrame();
      };
      embedded.onAccuracyChosen = (choice) => {
        for (const cloud of view.clouds.keys()) cloud.announceAccuracy(choice);
      };
      embedded.onStatistics = (statistics) => reportStageTimings(renderer, statistics);
      return embedded;
    });
    const isReady = (drawn: Clouds) =>
      view.embedded.prepare({
        camera: engineCamera(camera, pass.depth?.compare === 'greater-equal'),
        clouds: [...drawn.values()],
        widthPx: pass.widthPx,
        heightPx: pass.heightPx,
        depth: pass.depth,
        hasOccluders: pass.hasOccluders,
        writesDepth: [...drawn.keys()].some(({ depthWrite }) => depthWrite),
        accuracy: accuracyOf(drawn.keys()),
      });
    const wasThere = ([object, { cloud }]: [LayerCloud, CloudInstance]) =>
      view.clouds.get(object)?.cloud === cloud;
    // The clouds of the last frame stay while shaders for added clouds compile.
    const drawn = [clouds, new Map([...clouds].filter(wasThere))].find(isReady);
    if (!drawn) return;
    view.clouds = drawn;
    pass.interrupt((encoder, host) => {
      view.show(view.embedded.draw(encoder, host), pass.xPx, pass.yPx);
    });
    this.#shown = view;
    this.material.show(view.color!, view.xPx, view.yPx);
    for (const cloud of drawn.keys()) cloud.announceDrawn(nowMs);
  }

  #showDepth(): void {
    const { material } = this.#depthMesh;
    if (this.#shown?.depth) material.show(this.#shown.depth, this.#shown.xPx, this.#shown.yPx);
    else material.showNothing();
  }

  /** Returns the visible clouds, whatever their `layers`. */
  #shownClouds(): LayerCloud[] {
    for (const object of [...this.#clouds]) if (rootOf(object) !== this.parent) object.leave(this);
    return [...this.#clouds].filter((object) => object.opacity !== 0 && isShown(object));
  }

  /** If a callback throws, three abandons this frame and every later one, so errors are reported instead, each once. */
  #report(error: unknown): void {
    let hasListener = false;
    for (const cloud of this.#clouds) hasListener = cloud.tell(error) || hasListener;
    const text = String(error);
    if (hasListener || this.#reported.has(text)) return;
    this.#reported.add(text);
    console.error(error);
  }
}

/** Clouds in the scene, and their instances in a frame request. */
type Clouds = LayerView['clouds'];

/** Whether `object` and all of its ancestors are visible. */
function isShown(object: Object3D): boolean {
  for (let at: Object3D | null = object; at; at = at.parent) if (!at.visible) return false;
  return true;
}

/** Returns the instances of those `objects` that share a layer with `camera` and are uploaded. */
function instancesFor(
  objects: readonly LayerCloud[],
  engine: SplatEngine,
  camera: Camera,
  effectsOf: (object: LayerCloud) => CloudInstance['effects'],
): Clouds {
  const found = new Map<LayerCloud, CloudInstance>();
  for (const object of objects) {
    if (!object.layers.test(camera.layers)) continue;
    const cloud = object.uploadedTo(engine);
    if (!cloud) continue;
    const { opacity, shDegree, matrixWorld } = object;
    const effects = effectsOf(object);
    found.set(object, { cloud, modelMatrix: matrixWorld.elements, opacity, shDegree, effects });
  }
  return found;
}

/**
 * Makes the `drawn` clouds hold the planes for the accuracy of all shown clouds, even if this camera sees only some of them:
 * otherwise several cameras with different clouds would claim different planes in turn.
 */
function holdPlanes(shown: Iterable<LayerCloud>, drawn: Iterable<LayerCloud>, engine: SplatEngine): void {
  const accuracy = accuracyOf(shown);
  // Under a wish, the view itself claims the planes for the settings that it has chosen.
  const isWish = accuracy !== undefined && isAccuracyWish(accuracy);
  const settings = isWish ? null : engine.resolveAccuracy(accuracy).settings;
  for (const object of drawn) object.hold(engine, settings);
}

function accuracyOf(clouds: Iterable<LayerCloud>): AccuracyRequest | undefined {
  return combineAccuracies([...clouds].flatMap(({ accuracy }) => accuracy ?? []));
}

/** Converts three's camera, as three has prepared it for this render: matrices, clip depth from 0 to 1. */
function engineCamera(camera: Camera, isReversed: boolean): EngineCamera {
  const projection = camera.projectionMatrix.elements;
  const inMatrix = depthRange(projection, isReversed);
  const { near = inMatrix.near, far = inMatrix.far }: Camera & { near?: number; far?: number } = camera;
  return cameraFromMatrices(camera.matrixWorldInverse.elements, projection, { near, far });
}

/** Returns near and far of a camera that has only a matrix: the depths at which its clip depth is 0 and 1. */
function depthRange(p: readonly number[], isReversed: boolean): { near: number; far: number } {
  const isOrthographic = p[11] === 0;
  const atZero = p[14] / p[10];
  const atOne = isOrthographic ? (p[14] - 1) / p[10] : p[14] / (p[10] + 1);
  return isReversed ? { near: atOne, far: atZero } : { near: atZero, far: atOne };
}

function viewportTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3));
  // Empty bounds: three sorts the mesh by the layer's place alone, and the mesh adds nothing to the scene's extent.
  geometry.boundingSphere = new Sphere(new Vector3(), 0);
  geometry.boundingBox = new Box3();
  return geometry;
}
