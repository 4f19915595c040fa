import { expect, test } from 'vitest';
import { adapterLabel, hasNarrowSubgroups, requestSplatDevice } from './device.ts';

test.each([
  ['SwiftShader', 4, true],
  ['a driver for 256-bit vectors', 8, true],
  ['most GPUs', 32, false],
  ['a browser that names the limits of the specification', 128, false],
  ['a browser that knows nothing', 0, false],
  ['a browser without subgroups', undefined, false],
])('%s: subgroups of up to %s threads', (_, subgroupMaxSize, isNarrow) => {
  const adapterInfo = { subgroupMaxSize } as GPUAdapterInfo;
  expect(hasNarrowSubgroups({ adapterInfo })).toBe(isNarrow);
});

const NOTHING = { vendor: '', architecture: '', device: '', description: '', isFallbackAdapter: false };

/**
 * @fault Other WebGPUs: an adapter has no name
 * @consequence its description is shown
 */
test.each([
  [
    'nvidia hopper',
    { vendor: 'nvidia', architecture: 'hopper', device: '0x2330', description: 'NVIDIA H200' },
  ],
  ['acme 0x2330', { vendor: 'acme', device: '0x2330', description: 'an adapter' }],
  // Deno 2.9 on Mesa.
  [
    'llvmpipe (LLVM 15.0.6, 256 bits)',
    { vendor: '65541', device: '0', description: 'llvmpipe (LLVM 15.0.6, 256 bits)' },
  ],
  ['GPU 0 of vendor 65541', { vendor: '65541', device: '0' }],
  ['NVIDIA H200', { description: 'NVIDIA H200' }],
  // Firefox 153.
  ['software renderer that the browser does not name', { isFallbackAdapter: true }],
  ['GPU that the browser does not name', {}],
])('adapters are labelled, %s', (label, info) => {
  expect(adapterLabel({ ...NOTHING, ...info } as GPUAdapterInfo)).toBe(label);
});

test('a device has the features that the engine uses, or all but experimental ones for a renderer that shares it', async () => {
  const requested: unknown[] = [];
  const adapter = {
    features: new Set(['subgroups', 'shader-f16', 'chromium-experimental-thing']),
    limits: {},
    requestDevice: async ({ requiredFeatures }: GPUDeviceDescriptor) => requested.push(requiredFeatures),
  } as unknown as GPUAdapter;
  await requestSplatDevice({ adapter });
  await requestSplatDevice({ adapter, allFeatures: true });
  expect(requested).toEqual([['subgroups'], ['subgroups', 'shader-f16']]);
});
