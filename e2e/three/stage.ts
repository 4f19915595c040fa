import { createSplatRenderer, type SplatCloudObject, splatEngineOf } from '@websplatter/three';
import { Color, type Object3D, PerspectiveCamera, Scene, type WebGPURenderer } from 'three/webgpu';

export const SIZE_PX = 64;

export type RendererParameters = NonNullable<Parameters<typeof createSplatRenderer>[0]>;

/** RGBA, 0…255, top row first, of a square picture. */
export interface Pixels {
  readonly widthPx: number;
  readonly heightPx: number;
  readonly data: readonly number[];
}

/** A renderer, and a new scene with a camera at z = 3 that sees ±1.73 at z = 0. */
export interface Stage {
  readonly renderer: WebGPURenderer;
  readonly scene: Scene;
  readonly camera: PerspectiveCamera;
}

const renderers = new Map<string, Promise<WebGPURenderer>>();

/** Renderers are kept, one for each set of parameters, since a device and its shaders take long to make. */
export async function newStage(parameters: RendererParameters = {}): Promise<Stage> {
  const key = JSON.stringify(parameters);
  if (!renderers.has(key)) renderers.set(key, makeRenderer(parameters));
  const renderer = await renderers.get(key)!;
  const scene = new Scene();
  scene.background = new Color(0x000000);
  const camera = new PerspectiveCamera(60, 1, 0.1, 100);
  camera.position.z = 3;
  return { renderer, scene, camera };
}

export async function makeRenderer(parameters: RendererParameters): Promise<WebGPURenderer> {
  const canvas = document.createElement('canvas');
  document.body.append(canvas);
  const renderer = await createSplatRenderer({ canvas, ...parameters });
  renderer.setSize(SIZE_PX, SIZE_PX, false);
  return renderer;
}

/** Draws until all splats are in the picture: their shaders are compiled when they are first needed. */
export async function drawn(
  renderer: WebGPURenderer,
  scene: Object3D,
  draw: () => void,
  splatPasses = 1,
): Promise<void> {
  const engine = splatEngineOf(renderer);
  for (let attempt = 0; attempt < 20; attempt++) {
    const ready = nextNeededFrame(scene);
    const before = engine.counters().framesDrawn;
    draw();
    const passes = engine.counters().framesDrawn - before;
    if (passes >= splatPasses) return;
    await ready;
  }
  throw new Error('The splats were never drawn.');
}

function nextNeededFrame(scene: Object3D): Promise<void> {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error('No frame with splats within 20 s.')), 20_000);
    const onNeedsFrame = () => {
      clearTimeout(timer);
      resolve();
    };
    scene.traverse((object) => {
      if ((object as SplatCloudObject).isSplatCloudObject)
        (object as SplatCloudObject).addEventListener('needsframe', onNeedsFrame);
    });
  });
}

/** What is on the canvas; in the task in which it was drawn. */
export function canvasPixels(renderer: WebGPURenderer): Pixels {
  const canvas = renderer.domElement as HTMLCanvasElement;
  const { width, height } = canvas;
  const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })!;
  context.drawImage(canvas, 0, 0);
  return { widthPx: width, heightPx: height, data: [...context.getImageData(0, 0, width, height).data] };
}

/** Renders the stage with its splats and reads the canvas. */
export async function shot({ renderer, scene, camera }: Stage, splatPasses = 1): Promise<Pixels> {
  let pixels: Pixels | null = null;
  await drawn(
    renderer,
    scene,
    () => {
      renderer.render(scene, camera);
      pixels = canvasPixels(renderer);
    },
    splatPasses,
  );
  return pixels!;
}
