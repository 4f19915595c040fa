import {
  type AccuracyRequest,
  type Detail,
  InvalidArgumentError,
  Listeners,
  SplatEngine,
  WebGpuUnavailableError,
} from '@websplatter/core';
import type { WebGPURenderer } from 'three/webgpu';
import { SplatsUnsupportedRendererError, warnOfUntestedThree } from '../errors.ts';
import { type LossListener, tellOfLoss } from './tell-of-loss.ts';
import { deviceOf, hasWebGpuBackend, isWebGlForced } from './three-bridge.ts';

/** Options of the engine that draws splats for a renderer. */
export interface AdoptRendererOptions {
  /** How exactly and how fast to draw splats, or a target for an outcome; default `balanced`. */
  readonly accuracy?: AccuracyRequest;
  /** How much of the clouds to show; default `full`. `setSplatDetail` changes it. */
  readonly detail?: Detail;
  /** GPU memory for all streamed scenes together, bytes; default 512 MiB: see `EngineOptions`. */
  readonly streamBudgetBytes?: number;
}

interface RendererState extends LossListener {
  /** Null until it is made. */
  engine: SplatEngine | null;
  making: Promise<SplatEngine>;
  /** Why there is no engine. */
  failure: { readonly error: unknown } | null;
  detail: Detail;
  readonly lostListeners: Listeners<[GPUDeviceLostInfo]>;
  isDisposed: boolean;
}

const states = new WeakMap<object, RendererState>();

/** Renderers of tests without a GPU. */
interface NullRenderers {
  create(parameters: { readonly canvas?: unknown }): WebGPURenderer;
  /** Makes `renderer` draw nothing, and returns it. */
  takeOver(renderer: object): WebGPURenderer;
}

/** Null, except in tests that call `installNullRenderer`. */
export const nullRenderers: { current: NullRenderers | null } = { current: null };

/**
 * Prepares a WebGPURenderer of your own to draw splats on its device: initialises the renderer if
 * necessary, and fetches the engine. Clouds and loaders do so by themselves with default options;
 * call it before them to pass options, or to have the engine (`splatEngineOf`).
 * `renderer.dispose()` also frees all splats.
 *
 * @returns the renderer, so that react-three-fiber takes the call: `gl={(props) => adoptRenderer(new
 *   WebGPURenderer(props), options)}`.
 * @throws SplatsUnsupportedRendererError for a renderer that cannot draw splats; InvalidArgumentError
 *   for an unknown accuracy, and for options of a renderer that has an engine or waits for it;
 *   CodeUnavailableError if the engine's code cannot be fetched. After a failure, another call tries
 *   again.
 * @example
 * const renderer = new WebGPURenderer({ requiredLimits: await splatLimits() });
 * await adoptRenderer(renderer, { accuracy: 'high' });
 * const { adapterLabel } = splatEngineOf(renderer);
 */
export async function adoptRenderer<Renderer extends object>(
  renderer: Renderer,
  options?: AdoptRendererOptions,
): Promise<Renderer> {
  const known = states.get(renderer);
  const isNew = !known || known.failure !== null;
  if (options && !isNew)
    throw new InvalidArgumentError(
      'options',
      'This renderer has an engine already: call adoptRenderer before anything is loaded for it or drawn with it.',
    );
  await (isNew ? adopt(renderer, options) : known).making;
  return renderer;
}

/**
 * Returns the engine that draws splats for `renderer`.
 *
 * @throws SplatsUnsupportedRendererError for a renderer that cannot draw splats, or that
 *   `adoptRenderer` has not prepared yet; the error that `adoptRenderer` has failed with.
 * @example
 * await adoptRenderer(renderer);
 * const { adapterLabel } = splatEngineOf(renderer);
 */
export function splatEngineOf(renderer: object): SplatEngine {
  const engine = findSplatEngine(renderer);
  if (engine) return engine;
  throw new SplatsUnsupportedRendererError(
    'createSplatRenderer did not make this WebGPURenderer, and its engine is still being fetched: await ' +
      'adoptRenderer(renderer) before.',
  );
}

/**
 * Returns the engine that draws splats for `renderer`; if there is none yet, calls `adoptRenderer`
 * and returns null.
 *
 * @throws SplatsUnsupportedRendererError for a renderer that cannot draw splats; the error that
 *   `adoptRenderer` has failed with.
 * @example
 * const bytes = findSplatEngine(renderer)?.memory().totalBytes;
 */
export function findSplatEngine(renderer: object): SplatEngine | null {
  const { engine, failure } = stateOf(renderer);
  if (failure) throw failure.error;
  return engine;
}

/**
 * Changes the level of detail of clouds without a `detail` of their own, from the next frame of
 * `renderer` on. Clouds report an invalid detail when they are drawn.
 *
 * @throws SplatsUnsupportedRendererError for a renderer that cannot draw splats.
 * @example
 * setSplatDetail(renderer, { maxSplats: 500_000 });
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
 * @throws SplatsUnsupportedRendererError for a renderer that cannot draw splats.
 * @example
 * const stop = onDeviceLost(renderer, ({ message }) => console.warn(`Device lost: ${message}`));
 */
export function onDeviceLost(renderer: object, listener: (info: GPUDeviceLostInfo) => void): () => void {
  return stateOf(renderer).lostListeners.add(listener);
}

/** Lets an engine draw the splats of `renderer`, once it is made. `dispose` ends both. */
export function attachEngine(
  renderer: WebGPURenderer,
  engine: SplatEngine | Promise<SplatEngine>,
  detail: Detail,
): RendererState {
  const state = states.get(renderer) ?? newState(renderer);
  const take = (made: SplatEngine) => {
    state.engine = made;
    if (state.isDisposed) made.destroy();
    tellOfLoss(made, state);
    return made;
  };
  state.detail = detail;
  state.failure = null;
  state.making = engine instanceof Promise ? engine.then(take) : Promise.resolve(take(engine));
  state.making.catch((error: unknown) => {
    state.failure = { error };
  });
  return state;
}

function newState(renderer: WebGPURenderer): RendererState {
  warnOfUntestedThree();
  const state: RendererState = {
    engine: null,
    making: new Promise(() => {}),
    failure: null,
    detail: 'full',
    lostListeners: new Listeners(),
    onLost: (info) => {
      if (!state.isDisposed) state.lostListeners.call(info);
    },
    isDisposed: false,
  };
  states.set(renderer, state);
  const disposeThree = renderer.dispose.bind(renderer);
  renderer.dispose = async () => {
    if (state.isDisposed) return;
    state.isDisposed = true;
    try {
      await disposeThree();
    } finally {
      // three destroys a device only if it created it.
      state.engine?.destroy();
    }
  };
  return state;
}

function stateOf(renderer: object): RendererState {
  return states.get(renderer) ?? adopt(renderer);
}

function adopt(renderer: object, { detail = 'full', ...options }: AdoptRendererOptions = {}): RendererState {
  if (nullRenderers.current) {
    const error = new WebGpuUnavailableError('The null renderer of a test draws nothing: it has no engine.');
    const state = newState(nullRenderers.current.takeOver(renderer));
    state.making = Promise.reject(error);
    // Callers of `adoptRenderer` get the error.
    state.making.catch(() => {});
    return Object.assign(state, { detail });
  }
  checkBackend(renderer);
  return attachEngine(renderer, makeEngine(renderer, options), detail);
}

async function makeEngine(
  renderer: WebGPURenderer,
  options: Omit<AdoptRendererOptions, 'detail'>,
): Promise<SplatEngine> {
  await renderer.init();
  // three may have had to fall back.
  checkBackend(renderer);
  const { device, isMadeByThree } = deviceOf(renderer);
  const maker = isMadeByThree ? 'new WebGPURenderer' : 'adapter.requestDevice';
  try {
    return await SplatEngine.create({
      ...options,
      device,
      limitAdvice: `Load fewer splats, or allow what the GPU can: ${maker}({ requiredLimits: await splatLimits() }).`,
    });
  } catch (error) {
    // There is a device: splats cannot be drawn on this one.
    if (error instanceof WebGpuUnavailableError) throw new SplatsUnsupportedRendererError(error.message);
    throw error;
  }
}

/** @throws SplatsUnsupportedRendererError unless three draws with WebGPU. */
export function checkBackend(renderer: object): asserts renderer is WebGPURenderer {
  if (hasWebGpuBackend(renderer)) return;
  throw new SplatsUnsupportedRendererError(
    'Splats need a WebGPURenderer that draws with WebGPU: your own, that of createSplatRenderer or, in ' +
      `react-three-fiber, of a <SplatCanvas>; this is ${nameOf(renderer)}.`,
  );
}

function nameOf(renderer: object): string {
  const { isWebGLRenderer, isWebGPURenderer } = renderer as Record<string, unknown>;
  if (isWebGLRenderer) return 'three’s WebGLRenderer';
  if (!isWebGPURenderer) return `an object of the class ${renderer.constructor?.name ?? 'none'}`;
  const why = isWebGlForced(renderer)
    ? 'forceWebGL is set'
    : 'there is no WebGPU here, or its adapter lacks some of requiredLimits';
  return `one that draws with WebGL 2, because ${why}`;
}
