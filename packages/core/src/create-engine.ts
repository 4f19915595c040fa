import { checkEngineNumbers } from './check-options.ts';
import { DEFAULT_ACCURACY } from './data/accuracy/accuracy.ts';
import { checkAccuracy } from './data/accuracy/accuracy-target.ts';
import { fetched } from './data/errors.ts';
import { given } from './data/given.ts';
import type { SplatEngine as Engine, EngineOptions, EngineSeams } from './engine.ts';
import { checkDevice, requestSplatDevice } from './gpu/device.ts';
import { foreseeWorkers } from './io/loading/load-splats.ts';

/** Fetches the engine, and beside it the code that it will need first. */
async function fetchEngine() {
  // Callers that need the texts of the tiles meet the failure.
  import('./stages/tiles/tiles.texts.ts').catch(() => {});
  foreseeWorkers();
  return (await import('./engine.ts')).SplatEngine;
}

/**
 * Draws Gaussian splats on one WebGPU device. Made by `SplatEngine.create`.
 *
 * @interface
 * @example
 * const engine = await SplatEngine.create();
 * const cloud = await engine.load('/garden.ply');
 * const view = engine.createView({ canvas });
 * view.render({ camera, clouds: [{ cloud }], widthPx: 800, heightPx: 600 });
 */
export type SplatEngine = Engine;

export const SplatEngine = {
  /**
   * Creates an engine on `options.device`, or on a device of its own. Most of the engine's code is
   * fetched while the device is requested.
   *
   * @throws WebGpuUnavailableError if WebGPU is not available, or in its compatibility mode alone;
   *   InvalidArgumentError for unknown accuracy settings and for a negative limit or budget;
   *   CodeUnavailableError if the engine's code cannot be fetched.
   */
  create(options: EngineOptions = {}): Promise<SplatEngine> {
    return createEngine(options, {});
  },
};

/** As `SplatEngine.create`, with changes for tests, which are not checked. */
export async function createEngine(options: EngineOptions, seams: EngineSeams): Promise<SplatEngine> {
  // Reject unknown settings before a device is requested in vain.
  const { accuracy } = given(options);
  if (options.device !== undefined)
    given(
      options.device,
      { createBuffer: 'a function', adapterInfo: 'an object', limits: 'an object' },
      'device',
    );
  checkAccuracy(accuracy ?? DEFAULT_ACCURACY);
  checkEngineNumbers(options);
  const implementation = fetched('engine', fetchEngine());
  // Awaited below; if there is no device either, its error is thrown instead.
  implementation.catch(() => {});
  const ownsDevice = options.device === undefined;
  const device = options.device ?? (await requestSplatDevice(options));
  try {
    checkDevice(device);
    return new (await implementation)(device, ownsDevice, options, seams);
  } catch (error) {
    if (ownsDevice) device.destroy();
    throw error;
  }
}

/**
 * Prefetches the code that `SplatEngine.create` needs, if there is WebGPU. For pages that will
 * certainly draw, before they can create an engine. Never throws; `create` reports failures.
 *
 * @example
 * // On hover of the button that opens the scene.
 * foreseeEngine();
 */
export function foreseeEngine(): void {
  if (!globalThis.navigator?.gpu) return;
  // `create` fetches it again, and reports the error.
  fetchEngine().catch(() => {});
}
