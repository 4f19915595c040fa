import { WebGpuUnavailableError } from '@websplatter/core';
import { describe, expect, test } from 'vitest';
import {
  answerWhenLost,
  createSplatRenderer,
  isSupported,
  onDeviceLost,
  splatEngineOf,
} from './create-splat-renderer.ts';
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

test('a lost device leaves three no rejection that it does not expect', async () => {
  const device = { popErrorScope: () => Promise.reject(new Error('Instance dropped in popErrorScope')) };
  answerWhenLost(device as unknown as GPUDevice);
  expect(await device.popErrorScope()).toBeNull();
});

describe('another renderer', () => {
  test('has no engine, and the error says what to write instead', () => {
    const ask = () => splatEngineOf({ isWebGLRenderer: true });
    expect(ask).toThrow(SplatsUnsupportedRendererError);
    expect(ask).toThrow(/createSplatRenderer.*<SplatCanvas>.*WebGLRenderer/);
    expect(() => splatEngineOf({})).toThrow(/this is an object of the class Object, which it did not make/);
    expect(() => splatEngineOf({ isWebGPURenderer: true })).toThrow(
      /this is a WebGPURenderer that was made without/,
    );
    expect(() => splatEngineOf(Object.create(null))).toThrow(/of the class none/);
  });

  test('has no device to listen to', () => {
    expect(() => onDeviceLost({}, () => {})).toThrow(SplatsUnsupportedRendererError);
  });
});
