import { SplatEngine, sceneLimits } from '@websplatter/core';
import { WebGPURenderer, type WebGPURendererParameters } from 'three/webgpu';
import {
  type AdoptRendererOptions,
  attachEngine,
  checkBackend,
  nullRenderers,
  setSplatDetail,
} from './adopt-renderer.ts';

/** Options of three's WebGPURenderer and of the engine. */
export interface SplatRendererParameters
  extends AdoptRendererOptions,
    Omit<WebGPURendererParameters, 'device' | 'forceWebGL' | 'powerPreference' | 'requiredLimits'> {
  /** Device limits that the application needs, by name; default none, as in three. */
  readonly requiredLimits?: Readonly<Record<string, number>>;
  readonly powerPreference?: GPUPowerPreference | 'default';
  /** Entry point of WebGPU; default `navigator.gpu`. */
  readonly gpu?: GPU;
}

/**
 * Creates and initialises three's WebGPURenderer on a device with room for large scenes. `<Canvas
 * gl={…}>` of react-three-fiber accepts this function. `renderer.dispose()` also frees the device
 * and all splats on it.
 *
 * @throws WebGpuUnavailableError if there is no WebGPU, InvalidArgumentError for an unknown
 *   accuracy, CodeUnavailableError if the engine's code cannot be fetched,
 *   SplatsUnsupportedRendererError if three does not draw with WebGPU on the device.
 * @example
 * const renderer = await createSplatRenderer({ accuracy: 'balanced' });
 * renderer.setSize(innerWidth, innerHeight);
 * document.body.append(renderer.domElement);
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
  if (nullRenderers.current) {
    const renderer = nullRenderers.current.create(parameters);
    setSplatDetail(renderer, detail);
    return renderer;
  }
  const engine = await SplatEngine.create({
    accuracy,
    gpu,
    powerPreference: powerPreference === 'default' ? undefined : powerPreference,
    // three requests all features that it knows for a device of its own.
    allFeatures: true,
    requiredLimits,
    streamBudgetBytes,
  });
  answerWhenLost(engine.device);
  try {
    const renderer = new WebGPURenderer({ ...parameters, device: engine.device });
    await renderer.init();
    checkBackend(renderer);
    attachEngine(renderer, engine, detail);
    return renderer;
  } catch (error) {
    engine.destroy();
    throw error;
  }
}

/**
 * Returns the device limits that bound the size of scenes, at the adapter's maximum, for a renderer
 * of your own: `new WebGPURenderer({ requiredLimits: await splatLimits() })`. Empty without WebGPU.
 *
 * @param options options with which the renderer requests its adapter.
 * @example
 * const renderer = new WebGPURenderer({ requiredLimits: await splatLimits() });
 */
export async function splatLimits(options?: GPURequestAdapterOptions): Promise<Record<string, number>> {
  const adapter = await globalThis.navigator?.gpu?.requestAdapter(options);
  return adapter ? sceneLimits(adapter) : {};
}

/**
 * Whether WebGPU and a usable GPU adapter are available. False on servers. True in tests that call
 * `installNullRenderer`.
 *
 * @example
 * if (!(await isSupported())) document.body.append('This page needs WebGPU.');
 */
export async function isSupported(gpu: GPU | undefined = globalThis.navigator?.gpu): Promise<boolean> {
  try {
    return Boolean(nullRenderers.current ?? (await gpu?.requestAdapter()));
  } catch {
    // A browser that throws here has no usable adapter, which is the answer.
    return false;
  }
}

/**
 * Makes `popErrorScope` resolve with null when the device is lost, where it may reject. three does
 * not handle the rejection: each of its pipelines would cause an uncaught error.
 */
export function answerWhenLost(device: Pick<GPUDevice, 'popErrorScope'>): void {
  const pop = device.popErrorScope.bind(device);
  // `lost` of the device, which three and the engine follow, reports the loss.
  device.popErrorScope = () => pop().catch(() => null);
}
