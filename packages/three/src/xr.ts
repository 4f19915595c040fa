/**
 * Whether this browser can show splats in XR, and what it lacks if not.
 *
 * @module
 */

import { WebSplatterError } from '@websplatter/core';

/** The missing part that XR on WebGPU needs. */
export type XrLack =
  /** The browser has no WebXR, or the page is not served over https or from localhost. */
  | 'no-webxr'
  /** The browser's WebXR takes images of WebGL alone: it has no `XRGPUBinding`. */
  | 'no-webgpu-binding'
  /** There is no device for this kind of session, or the page may not use it. */
  | 'no-xr-device'
  /** No GPU adapter can draw for the XR device. */
  | 'no-xr-adapter';

/** Kinds of sessions that show splats in a headset, or over the picture of a device's camera. */
export type XrMode = 'immersive-vr' | 'immersive-ar';

/** Splats cannot be shown in an XR session here: `lack` and the message say why. */
export class SplatsXrError extends WebSplatterError {
  override readonly name = 'SplatsXrError';
  readonly lack: XrLack;

  constructor(lack: XrLack, message: string) {
    super('unsupported-xr', `Splats cannot be shown in XR here: ${message}`);
    this.lack = lack;
  }
}

/** The part of WebXR that is used here; TypeScript's libraries do not have it. */
interface XrSystem {
  isSessionSupported(mode: XrMode): Promise<boolean>;
}

/**
 * Resolves if the browser has all that an XR session with splats needs: WebXR, its binding to
 * WebGPU, a device for `mode`, and a GPU adapter for that. Ask before showing a button; asking
 * starts no session.
 *
 * @throws SplatsXrError naming the missing part.
 * @example
 * try {
 *   await checkXr('immersive-vr');
 * } catch (error) {
 *   if (error instanceof SplatsXrError) label.textContent = error.message;
 * }
 */
export async function checkXr(mode: XrMode = 'immersive-vr'): Promise<void> {
  const { navigator, XRGPUBinding } = globalThis as {
    readonly navigator?: Navigator & { readonly xr?: XrSystem };
    readonly XRGPUBinding?: unknown;
  };
  if (!navigator?.xr)
    throw new SplatsXrError(
      'no-webxr',
      'there is no WebXR. It needs a browser with WebXR, and a page served over https or from localhost.',
    );
  if (!XRGPUBinding)
    throw new SplatsXrError(
      'no-webgpu-binding',
      'this browser’s WebXR shows images of WebGL alone (it has no XRGPUBinding), and splats are drawn with WebGPU. In ' +
        'Chrome, look for the WebXR/WebGPU binding in chrome://flags.',
    );
  // A page whose permissions policy forbids WebXR is refused by an error.
  const hasDevice = await navigator.xr.isSessionSupported(mode).catch(() => false);
  if (!hasDevice)
    throw new SplatsXrError(
      'no-xr-device',
      `no device is connected for ${mode}, or this page may not use it.`,
    );
  const adapter = await xrGpu(navigator.gpu)?.requestAdapter();
  if (!adapter) throw new SplatsXrError('no-xr-adapter', 'no GPU adapter can draw for the XR device.');
}

/**
 * Whether `checkXr` finds all that an XR session with splats needs.
 *
 * @example
 * const button = document.createElement('button');
 * button.textContent = 'Enter VR';
 * if (await supportsXr('immersive-vr')) document.body.append(button);
 */
export async function supportsXr(mode?: XrMode): Promise<boolean> {
  try {
    await checkXr(mode);
    return true;
  } catch (error) {
    if (error instanceof SplatsXrError) return false;
    throw error;
  }
}

/**
 * Returns an entry point of WebGPU whose adapters can draw for XR devices: `createSplatRenderer({
 * gpu: xrGpu() })`. Undefined without WebGPU.
 *
 * @param gpu default `navigator.gpu`.
 * @example
 * const renderer = await createSplatRenderer({ gpu: xrGpu() });
 * renderer.xr.enabled = true;
 */
export function xrGpu(gpu: GPU | undefined = globalThis.navigator?.gpu): GPU | undefined {
  return (
    gpu &&
    new Proxy(gpu, {
      get(target, name) {
        if (name === 'requestAdapter')
          return (options?: GPURequestAdapterOptions) =>
            target.requestAdapter({ ...options, xrCompatible: true });
        const value: unknown = Reflect.get(target, name);
        return typeof value === 'function' ? value.bind(target) : value;
      },
    })
  );
}
