import { createSplatRenderer, type SplatCloudObject, splatEngineOf } from '@websplatter/three';
import { PATIENCE_MS } from '@websplatter/tools/patience';
import {
  Color,
  NoToneMapping,
  type Object3D,
  PerspectiveCamera,
  type RenderTarget,
  Scene,
  SRGBColorSpace,
  WebGPURenderer,
} from 'three/webgpu';

export const SIZE_PX = 64;

export type RendererParameters = NonNullable<Parameters<typeof createSplatRenderer>[0]>;

/** RGBA, top row first: 0…255 of a canvas, linear of a render target. */
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

/** Renderers are kept by their parameters, since a device and its shaders take long to make. */
export async function newStage(parameters: RendererParameters = {}): Promise<Stage> {
  const key = JSON.stringify(parameters);
  if (!renderers.has(key)) renderers.set(key, makeRenderer(parameters));
  const renderer = await renderers.get(key)!;
  reset(renderer);
  return { renderer, ...newScene() };
}

/** A black scene and its camera. */
export function newScene(): Pick<Stage, 'scene' | 'camera'> {
  const scene = new Scene();
  scene.background = new Color(0x000000);
  const camera = new PerspectiveCamera(60, 1, 0.1, 100);
  camera.position.z = 3;
  return { scene, camera };
}

export async function makeRenderer(parameters: RendererParameters): Promise<WebGPURenderer> {
  const canvas = document.createElement('canvas');
  document.body.append(canvas);
  return createSplatRenderer({ canvas, ...parameters });
}

/** A stage whose renderer an application has made by three alone. */
export async function foreignStage(
  parameters: ConstructorParameters<typeof WebGPURenderer>[0] = {},
): Promise<Stage> {
  const canvas = document.createElement('canvas');
  document.body.append(canvas);
  const renderer = new WebGPURenderer({ canvas, ...parameters });
  await renderer.init();
  reset(renderer);
  return { renderer, ...newScene() };
}

function reset(renderer: WebGPURenderer): void {
  renderer.setSize(SIZE_PX, SIZE_PX, false);
  renderer.setViewport(0, 0, SIZE_PX, SIZE_PX);
  renderer.setScissorTest(false);
  renderer.setRenderTarget(null);
  renderer.setMRT(null);
  renderer.setClearColor(0x000000, 1);
  renderer.toneMapping = NoToneMapping;
  renderer.outputColorSpace = SRGBColorSpace;
  renderer.autoClear = true;
  renderer.shadowMap.enabled = false;
}

/** Calls `draw` until it has drawn splats `splatPasses` times: first uses compile their shaders. */
export async function drawn(
  renderer: WebGPURenderer,
  scene: Object3D,
  draw: () => void,
  splatPasses = 1,
): Promise<void> {
  const engine = splatEngineOf(renderer);
  for (let attempt = 0; attempt < 10; attempt++) {
    const before = engine.counters().framesDrawn;
    draw();
    if (engine.counters().framesDrawn - before >= splatPasses) return;
    await nextNeededFrame(scene);
    // three renders a pass() once per frame of the page: another try would draw nothing.
    await nextFrame();
  }
  throw new Error('The splats were never drawn.');
}

/** Waits until `isDone`, or for as long as tests wait for anything. */
export async function until(isDone: () => boolean): Promise<void> {
  const endMs = performance.now() + PATIENCE_MS;
  while (!isDone() && performance.now() < endMs) await new Promise((resolve) => setTimeout(resolve, 10));
}

/** Waits for the next frame of the page, of which three has heard, too. */
export async function nextFrame(): Promise<void> {
  for (let i = 0; i < 2; i++) await new Promise((resolve) => requestAnimationFrame(resolve));
}

export function nextNeededFrame(scene: Object3D): Promise<void> {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error('No splat needed a frame.')), PATIENCE_MS);
    scene.traverse((object) => {
      if (!(object as SplatCloudObject).isSplatCloudObject) return;
      (object as SplatCloudObject).addEventListener('needsframe', () => {
        clearTimeout(timer);
        resolve();
      });
    });
  });
}

/**
 * The canvas's pixels of this task: premultiplied RGBA. A 2D canvas that copies it is
 * now and then given nothing by Chromium on SwiftShader, so the texture itself is read.
 */
export async function canvasPixels(renderer: WebGPURenderer): Promise<Pixels> {
  const texture = renderer.domElement.getContext('webgpu')!.getCurrentTexture();
  const { device } = splatEngineOf(renderer);
  const { width: widthPx, height: heightPx } = texture;
  const bytesPerRow = Math.ceil((4 * widthPx) / 256) * 256;
  const usage = GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ;
  const buffer = device.createBuffer({ size: bytesPerRow * heightPx, usage });
  const encoder = device.createCommandEncoder();
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, [widthPx, heightPx]);
  device.queue.submit([encoder.finish()]);
  await buffer.mapAsync(GPUMapMode.READ);
  const bytes = new Uint8Array(buffer.getMappedRange());
  const isBgra = texture.format.startsWith('bgra');
  const data: number[] = [];
  for (let y = 0; y < heightPx; y++) {
    for (let x = 0; x < widthPx; x++) {
      const [r, g, b, a] = bytes.subarray(y * bytesPerRow + 4 * x);
      data.push(...(isBgra ? [b, g, r, a] : [r, g, b, a]));
    }
  }
  buffer.destroy();
  return { widthPx, heightPx, data };
}

/** Renders the stage with its splats and reads the canvas. */
export async function shot(stage: Stage, splatPasses = 1): Promise<Pixels> {
  const { renderer, scene, camera } = stage;
  return shotOf(stage, () => renderer.render(scene, camera), splatPasses);
}

/**
 * The same when effects are on or off as `expected`, by name: the image changes once shaders are
 * compiled.
 */
export async function shotWith(stage: Stage, expected: Readonly<Record<string, boolean>>): Promise<Pixels> {
  const endMs = performance.now() + PATIENCE_MS;
  // Many times, because animations ask for frames while shaders compile.
  while (performance.now() < endMs) {
    // Listens before: shaders may be ready while the pixels are read, and nothing would tell again.
    const needed = nextNeededFrame(stage.scene);
    // Awaited only if the picture is not there yet.
    needed.catch(() => {});
    const pixels = await shot(stage);
    if (areOn(stage.renderer, expected)) return pixels;
    await needed;
  }
  throw new Error(`The effects never became ${JSON.stringify(expected)}.`);
}

/** Whether the last image was drawn with these effects on and off. */
export function areOn(renderer: WebGPURenderer, expected: Readonly<Record<string, boolean>>): boolean {
  const entries = splatEngineOf(renderer).effects();
  return Object.entries(expected).every(
    ([name, isOn]) => entries.find((entry) => entry.name === name)?.isOn === isOn,
  );
}

/** The same with another way to render. */
export async function shotOf(
  { renderer, scene }: Stage,
  render: () => void,
  splatPasses = 1,
): Promise<Pixels> {
  let pixels: Promise<Pixels> | null = null;
  const draw = () => {
    render();
    pixels = canvasPixels(renderer);
  };
  await drawn(renderer, scene, draw, splatPasses);
  return pixels!;
}

/** The canvas with nothing but meshes. */
export function meshShot({ renderer, scene, camera }: Stage): Promise<Pixels> {
  renderer.render(scene, camera);
  return canvasPixels(renderer);
}

/** Renders the stage into `target` and reads it. */
export async function targetShot(stage: Stage, target: RenderTarget): Promise<Pixels> {
  const { renderer, scene, camera } = stage;
  await drawn(renderer, scene, () => {
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    renderer.setRenderTarget(null);
  });
  return targetPixels(renderer, target);
}

export async function targetPixels(
  renderer: WebGPURenderer,
  target: RenderTarget,
  face = 0,
  textureIndex = 0,
): Promise<Pixels> {
  const { width: widthPx, height: heightPx, texture } = target;
  const values = await renderer.readRenderTargetPixelsAsync(
    target,
    0,
    0,
    widthPx,
    heightPx,
    textureIndex,
    face,
  );
  const bytesPerValue = values.BYTES_PER_ELEMENT;
  // Rows are padded to 256 bytes.
  const rowValues = (Math.ceil((4 * widthPx * bytesPerValue) / 256) * 256) / bytesPerValue;
  const data: number[] = [];
  for (let y = 0; y < heightPx; y++) {
    for (let i = 0; i < 4 * widthPx; i++) {
      const value = values[y * rowValues + i];
      data.push(values instanceof Uint16Array ? fromHalf(value) : value);
    }
  }
  if (data.some((value) => value === undefined)) throw new Error(`${texture.name} was not read in full.`);
  return { widthPx, heightPx, data };
}

function fromHalf(bits: number): number {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  return sign * (exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15));
}
