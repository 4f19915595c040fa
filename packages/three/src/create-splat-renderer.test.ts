import { WebGpuUnavailableError } from '@websplatter/core';
import { describe, expect, test } from 'vitest';
import { createSplatRenderer, isSupported, onDeviceLost, splatEngineOf } from './create-splat-renderer.ts';
import { SplatsUnsupportedRendererError } from './errors.ts';

/** WebGPU that finds no adapter. */
const emptyGpu = { requestAdapter: async () => null } as unknown as GPU;

describe('support', () => {
  test('is none without WebGPU, without an adapter, and where asking fails', async () => {
    expect(await isSupported()).toBe(false);
    expect(await isSupported(emptyGpu)).toBe(false);
    const failing = { requestAdapter: () => Promise.reject(new Error('blocked')) } as unknown as GPU;
    expect(await isSupported(failing)).toBe(false);
  });

  test('is there with an adapter', async () => {
    expect(await isSupported({ requestAdapter: async () => ({}) } as unknown as GPU)).toBe(true);
  });
});

test('no renderer is made without WebGPU', async () => {
  await expect(createSplatRenderer({ gpu: emptyGpu })).rejects.toThrow(WebGpuUnavailableError);
});

describe('of another renderer', () => {
  test('the engine is refused, with what to write instead', () => {
    const ask = () => splatEngineOf({ isWebGLRenderer: true });
    expect(ask).toThrow(SplatsUnsupportedRendererError);
    expect(ask).toThrow(/WebGLRenderer.*<Canvas gl=\{createSplatRenderer\}>/);
    expect(() => splatEngineOf({})).toThrow(/was not made by createSplatRenderer/);
  });

  test('the device’s loss is not heard of', () => {
    expect(() => onDeviceLost({}, () => {})).toThrow(SplatsUnsupportedRendererError);
  });
});
