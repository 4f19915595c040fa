import { WebGpuUnavailableError } from '@websplatter/core';
import { describe, expect, test } from 'vitest';
import { createSplatRenderer, isSupported, onDeviceLost, splatEngineOf } from './create-splat-renderer.ts';
import { SplatsUnsupportedRendererError } from './errors.ts';

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

describe('another renderer', () => {
  test('has no engine, and the error says what to write instead', () => {
    const ask = () => splatEngineOf({ isWebGLRenderer: true });
    expect(ask).toThrow(SplatsUnsupportedRendererError);
    expect(ask).toThrow(/createSplatRenderer.*<SplatCanvas>.*WebGLRenderer/);
    expect(() => splatEngineOf({})).toThrow(/this one is another/);
  });

  test('has no device to listen to', () => {
    expect(() => onDeviceLost({}, () => {})).toThrow(SplatsUnsupportedRendererError);
  });
});
