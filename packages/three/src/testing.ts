/**
 * Tests without a GPU (`@websplatter/three/testing`): scenes load and report, and nothing is drawn.
 *
 * @module
 */
import {
  Backend,
  type Camera,
  type Object3D,
  Renderer,
  WebGPUCoordinateSystem,
  type WebGPURenderer,
} from 'three/webgpu';
import { SplatCloudObject } from './cloud/splat-cloud-object.ts';
import { nullRenderers } from './renderer/adopt-renderer.ts';

/**
 * Lets splats be tested without a GPU: every renderer that gets its first splats after this call draws
 * nothing, and `createSplatRenderer` makes renderers that draw nothing. Call it once,
 * in the setup file of your tests.
 *
 * Files are read, by the same code as in a browser, and stay in main memory. Objects keep their
 * transforms, props, bounds and events, and rays hit them. `render` of such a renderer updates
 * matrices, and reports `firstframe` and `complete` of each visible cloud with splats. There is no
 * engine: `findSplatEngine` returns null, and `adoptRenderer` rejects with a WebGpuUnavailableError.
 * `pick` resolves with null.
 *
 * @returns a function that ends this for further renderers.
 * @example
 * installNullRenderer();
 * const renderer = await createSplatRenderer();
 * const data = await new SplatLoader().loadAsync(file);
 * scene.add(new SplatCloudObject(data));
 * renderer.render(scene, camera);
 */
export function installNullRenderer(): () => void {
  nullRenderers.current = { create, takeOver };
  return () => {
    nullRenderers.current = null;
  };
}

/** three's renderer without a GPU: it has sizes, a canvas and a loop. */
function create({ canvas = detachedCanvas() }: { readonly canvas?: unknown }): WebGPURenderer {
  const renderer = new Renderer(new NullBackend({ canvas: canvas as HTMLCanvasElement }));
  return Object.assign(renderer, { isWebGPURenderer: true }) as unknown as WebGPURenderer;
}

class NullBackend extends Backend {
  get coordinateSystem() {
    return WebGPUCoordinateSystem;
  }
}

function detachedCanvas(): object {
  if ('document' in globalThis) return document.createElement('canvas');
  return Object.assign(new EventTarget(), { width: 0, height: 0, style: {}, setAttribute() {} });
}

function takeOver(renderer: object): WebGPURenderer {
  const render = (scene: Object3D, camera: Camera) => {
    if (scene.matrixWorldAutoUpdate) scene.updateMatrixWorld();
    if (!camera.parent && camera.matrixWorldAutoUpdate) camera.updateMatrixWorld();
    scene.traverseVisible((object) => {
      const isShown = object instanceof SplatCloudObject && object.data && object.drawnOpacity > 0;
      if (isShown && object.layers.test(camera.layers)) object.announceDrawn(performance.now(), []);
    });
  };
  const renderAsync = async (scene: Object3D, camera: Camera) => render(scene, camera);
  const nothing = async () => {};
  // A renderer of a test may have no `dispose`.
  const { dispose = nothing } = renderer as Partial<WebGPURenderer>;
  const methods = { dispose, render, renderAsync, compile: nothing, compileAsync: nothing };
  // Not assigned: some of three's methods have a getter only.
  for (const [name, value] of Object.entries(methods))
    Object.defineProperty(renderer, name, { value, writable: true, configurable: true });
  return renderer as WebGPURenderer;
}
