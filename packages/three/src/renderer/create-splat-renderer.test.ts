import { WebGpuUnavailableError } from '@websplatter/core';
import { describe, expect, test, vi } from 'vitest';
import { answerWhenLost, createSplatRenderer, isSupported, splatLimits } from './create-splat-renderer.ts';

/** WebGPU without an adapter. */
const emptyGpu = { requestAdapter: async () => null } as unknown as GPU;

describe('support', () => {
  test('is missing without WebGPU, without an adapter, and if the request fails', async () => {
    expect(await isSupported()).toBe(false);
    expect(await isSupported(emptyGpu)).toBe(false);
    const failing = { requestAdapter: () => Promise.reject(new Error('blocked')) } as unknown as GPU;
    expect(await isSupported(failing)).toBe(false);
  });

  test('is present with an adapter', async () => {
    expect(await isSupported({ requestAdapter: async () => ({}) } as unknown as GPU)).toBe(true);
  });
});

test('createSplatRenderer rejects without WebGPU', async () => {
  await expect(createSplatRenderer({ gpu: emptyGpu })).rejects.toThrow(WebGpuUnavailableError);
});

test('a lost device leaves three no rejection that it does not expect', async () => {
  const device = { popErrorScope: () => Promise.reject(new Error('Instance dropped in popErrorScope')) };
  answerWhenLost(device as unknown as GPUDevice);
  expect(await device.popErrorScope()).toBeNull();
});

test('limits of the GPU are those that make room for scenes', async () => {
  expect(await splatLimits()).toEqual({});
  const requestAdapter = vi.fn(async () => ({ limits: { maxBufferSize: 8, maxBindGroups: 4 } }));
  vi.stubGlobal('navigator', { gpu: { requestAdapter } });
  const options = { powerPreference: 'high-performance' } as const;
  expect(await splatLimits(options)).toMatchObject({ maxBufferSize: 8 });
  expect(await splatLimits()).not.toHaveProperty('maxBindGroups');
  expect(requestAdapter).toHaveBeenCalledWith(options);
  vi.unstubAllGlobals();
});
