import { expect, test, vi } from 'vitest';
import { GpuMemory } from './gpu-memory.ts';

vi.stubGlobal('GPUBufferUsage', { STORAGE: 128 });

/** A buffer of 16 bytes in a part of some memory, and the function that ends its map. */
function memoryWithBuffer() {
  let isHeld = true;
  let succeed = () => {};
  let fail = (_reason: Error) => {};
  const mapping = new Promise<void>((resolve, reject) => {
    succeed = resolve;
    fail = reject;
  });
  const made = {
    mapAsync: () => mapping,
    destroy: () => {
      isHeld = false;
    },
  };
  const limits = { maxBufferSize: 16, maxStorageBufferBindingSize: 16 };
  const device = { limits, createBuffer: () => made } as unknown as GPUDevice;
  const memory = new GpuMemory(device);
  const part = memory.part();
  const buffer = part.createBuffer('rows', 16, 0);
  return { memory, part, buffer, succeed, fail, isHeld: () => isHeld };
}

const WRITE = 2;

test('destroys a buffer at once', () => {
  const { memory, part, buffer, isHeld } = memoryWithBuffer();
  expect(memory.heldBytes).toBe(16);
  part.destroy(buffer);
  expect(isHeld()).toBe(false);
  expect(memory.heldBytes).toBe(0);
});

test.each(['succeed', 'fail'] as const)(
  'destroys a buffer that is being mapped when the map has ended: %s',
  async (end) => {
    const { memory, part, buffer, isHeld, ...ends } = memoryWithBuffer();
    const seen = part.map(buffer, WRITE).then(isHeld, isHeld);
    // The whole may end before its parts do.
    memory.destroy(buffer);
    expect(memory.heldBytes, 'counted').toBe(0);
    expect(isHeld()).toBe(true);
    ends[end](new Error('lost'));
    expect(await seen, 'held for those who wait for the map').toBe(true);
    expect(isHeld()).toBe(false);
  },
);

test('destroys a buffer at once after its map has ended', async () => {
  const { part, buffer, succeed, isHeld } = memoryWithBuffer();
  succeed();
  await part.map(buffer, WRITE);
  part.destroy(buffer);
  expect(isHeld()).toBe(false);
});

test('says how the limits of a device are raised, as its owner knows it', () => {
  const limits = { maxBufferSize: 16, maxStorageBufferBindingSize: 8 };
  const device = { limits } as unknown as GPUDevice;
  const part = new GpuMemory(device, undefined, null, 'Ask for more.').part();
  expect(() => part.check('keys', 12, 128)).toThrow(
    /^keys needs 12 bytes in one buffer and this device allows 8 \(maxStorageBufferBindingSize\)\. Ask for more\.$/,
  );
  expect(() => part.check('rows', 20, 0)).toThrow('Ask for more.');
  expect(() => new GpuMemory(device).check('rows', 20, 0)).toThrow('let the engine make its own device');
});
