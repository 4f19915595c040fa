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

/** The layer of the scene whose root is `root`, added to it where it has none. */
export function layerOf(root: Object3D): SplatLayer {
  let layer = layers.get(root);
  if (!layer) {
    layer = new SplatLayer();
    layers.set(root, layer);
  }
  if (layer.parent !== root) root.add(layer);
  return layer;
}

/** The object at the top of the tree that `object` is in; itself where it is in none. */
export function rootOf(object: Object3D): Object3D {
  let root = object;
  while (root.parent) root = root.parent;
  return root;
}

/**
 * Draws all clouds of a scene, sorted together, as one of three's transparent objects. Before three draws it, the pass is
 * interrupted for the splats; the object itself is a triangle over the viewport that shows the result.
 */
export class SplatLayer extends Mesh<BufferGeometry, ColorLayerMaterial> {
  readonly #clouds = new Set<LayerCloud>();
  readonly #views = new LayerViews();
  readonly #depthMesh = new Mesh(this.geometry, new DepthLayerMaterial());
  readonly #reported = new Set<string>();
  /** What the triangle shows in the draw that is going on; null where it shows nothing. */
  #shown: LayerView | null = null;

  constructor() {
    super(viewportTriangle(), new ColorLayerMaterial());
    this.name = 'splats';
    this.add(this.#depthMesh);
    for (const mesh of [this, this.#depthMesh]) {
      mesh.frustumCulled = false;
      mesh.matrixAutoUpdate = false;
      mesh.matrixWorldAutoUpdate = false;
      // Each cloud has layers of its own, which are looked at for each camera.
      mesh.layers.enableAll();
      mesh.raycast = () => {};
    }
    // One place for both and ids in succession: three draws the second directly after the first, sorted or not.
    this.#depthMesh.matrixWorld = this.matrixWorld;
    this.onBeforeRender = (renderer, scene, camera) => this.#draw(renderer, scene, camera);
    this.#depthMesh.onBeforeRender = () => this.#showDepth();
  }

  /** Takes `cloud` in, or takes note of where it has moved to. */
  place(cloud: LayerCloud): void {
    this.#clouds.add(cloud);
    this.#arrange();
  }

  /** Draws `cloud` no longer. With the last one the layer leaves the scene and frees what it holds. */
  drop(cloud: LayerCloud): void {
    if (!this.#clouds.delete(cloud)) return;
    this.#arrange();
    // Not at once: three may be walking the scene or drawing this very object, and the cloud may come back in this task.
    queueMicrotask(() => {
      if (this.#clouds.size > 0) return;
      this.removeFromParent();
      this.#free();
    });
  }

  /** What is under a pixel of the latest picture from `camera`, or null. */
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

  /** Measures the latest picture with `cloud`; null where there is none. */
  chooseAccuracy(cloud: LayerCloud, options?: ChooseAccuracyOptions): Promise<AccuracyChoice> | null {
    return this.#views.latestWith(cloud)?.embedded.chooseAccuracy(options) ?? null;
  }

  /** Frees what the layer holds on GPUs; it may be drawn again. */
  #free(): void {
    this.#views.destroyAll();
    this.material.dispose();
    this.#depthMesh.material.dispose();
    this.geometry.dispose();
  }

  /** Where three sorts the layer among its transparent objects. */
  #arrange(): void {
    const box = new Box3();
    let renderOrder: number | null = null;
    let writesDepth = false;
    for (const cloud of this.#clouds) {
      box.union(cloud.worldBounds);
      renderOrder = Math.max(renderOrder ?? cloud.renderOrder, cloud.renderOrder);
      writesDepth ||= cloud.writesDepth;
    }
    if (!box.isEmpty()) this.matrixWorld.setPosition(box.getCenter(new Vector3()));
    this.renderOrder = renderOrder ?? 0;
    this.#depthMesh.renderOrder = this.renderOrder;
    this.#depthMesh.visible = writesDepth;
  }

  #draw(renderer: object, scene: Scene, camera: Camera): void {
    this.#shown = null;
    this.material.showNothing();
    // Such passes are about meshes: shadows, normals, depth.
    if (scene.overrideMaterial) return;
    try {
      const engine = splatEngineOf(renderer);
      const pass = openPass(renderer as WebGPURenderer, scene, camera, this);
      if (pass) this.#drawInto(pass, renderer as WebGPURenderer, engine, scene, camera);
    } catch (error) {
      // Of a lost device its renderer tells.
      if (!(error instanceof DestroyedError)) this.#report(error);
      // Nothing of this library can be shown by such a renderer, and it does not know the layer's material either.
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
        writesDepth: [...drawn.keys()].some(({ writesDepth }) => writesDepth),
        accuracy: accuracyOf(drawn.keys()),
      });
    const wasThere = ([object, { cloud }]: [LayerCloud, CloudInstance]) =>
      view.clouds.get(object)?.cloud === cloud;
    // What was there stays, while shaders for what has come to it are being compiled.
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

  /** What there is to see for cameras of all layers. */
  #shownClouds(): LayerCloud[] {
    for (const object of [...this.#clouds]) if (rootOf(object) !== this.parent) object.leave(this);
    return [...this.#clouds].filter((object) => object.opacity > 0 && isShown(object));
  }

  /** three gives up its frame where a callback throws, and every one after: so errors are told of, each once. */
  #report(error: unknown): void {
    let isHeard = false;
    for (const cloud of this.#clouds) isHeard = cloud.tell(error) || isHeard;
    const text = String(error);
    if (isHeard || this.#reported.has(text)) return;
    this.#reported.add(text);
    console.error(error);
  }
}

/** Objects, and what stands for them on the GPU. */
type Clouds = LayerView['clouds'];

/** Whether `object` and all that it is in are visible. */
function isShown(object: Object3D): boolean {
  for (let at: Object3D | null = object; at; at = at.parent) if (!at.visible) return false;
  return true;
}

/** Those of `objects` that `camera` is to see, and what stands for them on the GPU. */
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
 * Has `drawn` hold what the accuracy of all that is shown takes, whichever camera sees how much of it: else the views of a
 * frame would ask for one after the other.
 */
function holdPlanes(shown: Iterable<LayerCloud>, drawn: Iterable<LayerCloud>, engine: SplatEngine): void {
  const accuracy = accuracyOf(shown);
  // A view asks for what it has chosen because of a wish.
  const isWish = accuracy !== undefined && isAccuracyWish(accuracy);
  const settings = isWish ? null : engine.resolveAccuracy(accuracy).settings;
  for (const object of drawn) object.hold(engine, settings);
}

function accuracyOf(clouds: Iterable<LayerCloud>): AccuracyRequest | undefined {
  return combineAccuracies([...clouds].flatMap(({ accuracy }) => accuracy ?? []));
}

/** three's camera as three has prepared it for this render: matrices, clip depth from 0 to 1. */
function engineCamera(camera: Camera, isReversed: boolean): EngineCamera {
  const projection = camera.projectionMatrix.elements;
  const inMatrix = depthRange(projection, isReversed);
  const { near = inMatrix.near, far = inMatrix.far }: Camera & { near?: number; far?: number } = camera;
  return cameraFromMatrices(camera.matrixWorldInverse.elements, projection, { near, far });
}

/** Near and far of a camera that has only a matrix: where its clip depth is 0 and 1. */
function depthRange(p: readonly number[], isReversed: boolean): { near: number; far: number } {
  const isOrthographic = p[11] === 0;
  const atZero = p[14] / p[10];
  const atOne = isOrthographic ? (p[14] - 1) / p[10] : p[14] / (p[10] + 1);
  return isReversed ? { near: atOne, far: atZero } : { near: atZero, far: atOne };
}

function viewportTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3));
  // Sorted by the layer's place alone, and no part of the scene's extent.
  geometry.boundingSphere = new Sphere(new Vector3(), 0);
  geometry.boundingBox = new Box3();
  return geometry;
}
