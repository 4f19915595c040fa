import { type AccuracyRequest, type Detail, SplatEngine } from '@websplatter/core';
import { WebGPURenderer, type WebGPURendererParameters } from 'three/webgpu';
import { SplatsUnsupportedRendererError } from './errors.ts';
import { hasWebGpuBackend } from './three-bridge.ts';

/** Options of three's WebGPURenderer and of the engine. */
export interface SplatRendererParameters
  extends Omit<WebGPURendererParameters, 'device' | 'forceWebGL' | 'powerPreference' | 'requiredLimits'> {
  /** Device limits that the application needs, by name; default none, as in three. */
  readonly requiredLimits?: Readonly<Record<string, number>>;
  /** How exactly and how fast to draw splats, or a target for an outcome; default `balanced`. */
  readonly accuracy?: AccuracyRequest;
  /** How much of the clouds to show; default `full`. `setSplatDetail` changes it. */
  readonly detail?: Detail;
  /** See `EngineOptions`: GPU memory for all scenes that stream, together; default 512 MiB. */
  readonly streamBudgetBytes?: number;
  readonly powerPreference?: GPUPowerPreference | 'default';
  /** Entry point of WebGPU; default `navigator.gpu`. */
  readonly gpu?: GPU;
}

interface RendererState {
  readonly engine: SplatEngine;
  detail: Detail;
  readonly lostListeners: Set<(info: GPUDeviceLostInfo) => void>;
  isDisposed: boolean;
}

const states = new WeakMap<object, RendererState>();

/**
 * Creates and initialises three's WebGPURenderer on a device with room for large scenes. `<Canvas
 * gl={…}>` of react-three-fiber accepts this function. `renderer.dispose()` also frees the device
 * and all splats on it.
 *
 * @throws WebGpuUnavailableError if there is no WebGPU, InvalidArgumentError for an unknown
 *   accuracy, CodeUnavailableError if the engine's code cannot be fetched,
 *   SplatsUnsupportedRendererError if three does not draw with WebGPU on the device.
 */
export async function createSplatRenderer({
  accuracy,
  detail = 'full',
  gpu,
  powerPreference,
  requiredLimits,
  streamBudgetBytes,
  ...parameters
}: SplatRendererParameters = {}): Promise<WebGPURenderer> {
  const engine = await SplatEngine.create({
    accuracy,
    gpu,
    powerPreference: powerPreference === 'default' ? undefined : powerPreference,
    // As three requests for a device of its own: those that it knows, which grow with its versions.
    allFeatures: true,
    requiredLimits,
    streamBudgetBytes,
  });
  answerWhenLost(engine.device);
  try {
    const renderer = new WebGPURenderer({ ...parameters, device: engine.device });
    await renderer.init();
    if (!hasWebGpuBackend(renderer)) {
      throw new SplatsUnsupportedRendererError('three fell back to WebGL 2; the console says why.');
    }
    attach(renderer, engine, detail);
    return renderer;
  } catch (error) {
    engine.destroy();
    throw error;
  }
}

/**
 * Returns the engine that draws splats for `renderer`.
 *
 * @throws SplatsUnsupportedRendererError for a renderer that `createSplatRenderer` did not make.
 */
export function splatEngineOf(renderer: object): SplatEngine {
  return stateOf(renderer).engine;
}

/**
 * Changes how much of the clouds `renderer` shows from its next frame on, where they have no
 * `detail` of their own. Clouds report an invalid one when they are drawn.
 *
 * @throws SplatsUnsupportedRendererError as `splatEngineOf`.
 */
export function setSplatDetail(renderer: object, detail: Detail): void {
  stateOf(renderer).detail = detail;
}

/** Returns the detail of clouds that have none of their own. */
export function splatDetailOf(renderer: object): Detail {
  return stateOf(renderer).detail;
}

/**
 * Calls `listener` when the renderer's device is lost: by a reset of the driver, the end of the
 * browser's GPU process, or `device.destroy()`, but not by `renderer.dispose()`. three draws
 * nothing from then on; a new renderer is needed.
 *
 * @returns a function that stops listening.
 */
export function onDeviceLost(renderer: object, listener: (info: GPUDeviceLostInfo) => void): () => void {
  const { lostListeners } = stateOf(renderer);
  lostListeners.add(listener);
  return () => lostListeners.delete(listener);
}

/** Whether WebGPU and a usable GPU adapter are available. False on servers. */
export async function isSupported(gpu: GPU | undefined = globalThis.navigator?.gpu): Promise<boolean> {
  try {
    return Boolean(await gpu?.requestAdapter());
  } catch {
    return false;
  }
}

/**
 * Makes a device that is lost find no error in what is not drawn any more. It may reject instead,
 * which three does not expect: each pipeline of a lost device would be an uncaught error.
 */
export function answerWhenLost(device: Pick<GPUDevice, 'popErrorScope'>): void {
  const pop = device.popErrorScope.bind(device);
  device.popErrorScope = () => pop().catch(() => null);
}

function attach(renderer: WebGPURenderer, engine: SplatEngine, detail: Detail): void {
  const state: RendererState = { engine, detail, lostListeners: new Set(), isDisposed: false };
  states.set(renderer, state);
  void engine.lost.then((info) => {
    if (!state.isDisposed) for (const listener of [...state.lostListeners]) listener(info);
  });
  const disposeThree = renderer.dispose.bind(renderer);
  renderer.dispose = async () => {
    if (state.isDisposed) return;
    state.isDisposed = true;
    try {
      await disposeThree();
    } finally {
      // three destroys a device only if it created it.
      engine.destroy();
    }
  };
}

function stateOf(renderer: object): RendererState {
  const state = states.get(renderer);
  if (state) return state;
  throw new SplatsUnsupportedRendererError(
    `Splats need a renderer of createSplatRenderer, in react-three-fiber a <SplatCanvas>; this is ${nameOf(renderer)}.`,
  );
}

function nameOf(renderer: object): string {
  const { isWebGLRenderer, isWebGPURenderer } = renderer as Record<string, unknown>;
  if (isWebGLRenderer) return 'three’s WebGLRenderer';
  if (isWebGPURenderer) return 'a WebGPURenderer that was made without it';
  return `an object of the class ${renderer.constructor?.name ?? 'none'}, which it did not make`;
}
