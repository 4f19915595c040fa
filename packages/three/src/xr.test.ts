import { afterEach, describe, expect, test, vi } from 'vitest';
import { checkXr, SplatsXrError, supportsXr, xrGpu } from './xr.ts';

afterEach(() => {
  vi.unstubAllGlobals();
});

/** A browser with everything but for the given parts. */
function browser({
  hasXr = true,
  hasBinding = true,
  isSessionSupported = async (_mode: string): Promise<boolean> => true,
  requestAdapter = async (_options?: object): Promise<object | null> => ({}),
} = {}): void {
  vi.stubGlobal('XRGPUBinding', hasBinding ? class {} : undefined);
  const xr = hasXr ? { isSessionSupported } : undefined;
  vi.stubGlobal('navigator', { gpu: { requestAdapter }, xr });
}

describe('asking for XR', () => {
  test('finds a browser, a device and an adapter that can', async () => {
    const isSessionSupported = vi.fn(async (_mode: string): Promise<boolean> => true);
    const requestAdapter = vi.fn(async () => ({}));
    browser({ isSessionSupported, requestAdapter });
    await checkXr('immersive-ar');
    expect(await supportsXr()).toBe(true);
    expect(isSessionSupported.mock.calls).toEqual([['immersive-ar'], ['immersive-vr']]);
    expect(requestAdapter).toHaveBeenCalledWith({ xrCompatible: true });
  });

  test.each([
    ['no-webxr', /https/, { hasXr: false }],
    ['no-webgpu-binding', /WebGL alone.*chrome:\/\/flags/, { hasBinding: false }],
    ['no-xr-device', /immersive-vr/, { isSessionSupported: async () => false }],
    ['no-xr-device', /immersive-vr/, { isSessionSupported: () => Promise.reject(new Error('forbidden')) }],
    ['no-xr-adapter', /adapter/, { requestAdapter: async () => null }],
  ] as [string, RegExp, Parameters<typeof browser>[0]][])(
    'names what is missing: %s',
    async (lack, message, lacking) => {
      browser(lacking);
      const error = await checkXr().catch((thrown: unknown) => thrown);
      expect(error).toBeInstanceOf(SplatsXrError);
      expect(error).toMatchObject({ lack, code: 'unsupported-xr', message: expect.stringMatching(message) });
      expect(await supportsXr()).toBe(false);
    },
  );

  test('finds nothing on a server', async () => {
    vi.stubGlobal('navigator', undefined);
    await expect(checkXr()).rejects.toMatchObject({ lack: 'no-webxr' });
    expect(xrGpu()).toBeUndefined();
  });
});

describe('WebGPU for XR', () => {
  test('asks for adapters that can draw for the device, and is otherwise the browser’s', async () => {
    const gpu = {
      wgslLanguageFeatures: new Set(['a']),
      getPreferredCanvasFormat() {
        return this === gpu ? 'bgra8unorm' : 'of another object';
      },
      requestAdapter: vi.fn(async () => null),
    };
    const forXr = xrGpu(gpu as unknown as GPU)!;
    await forXr.requestAdapter({ powerPreference: 'low-power' });
    expect(gpu.requestAdapter).toHaveBeenCalledWith({ powerPreference: 'low-power', xrCompatible: true });
    expect(forXr.getPreferredCanvasFormat()).toBe('bgra8unorm');
    expect(forXr.wgslLanguageFeatures).toBe(gpu.wgslLanguageFeatures);
  });
});
