import { describe, expect, vi } from 'vitest';
import { gpuTest, sharedTestGpu, shareTestDevice } from '../gpu-test.ts';

/** COPY_DST | COPY_SRC. */
const USAGE = 0x8 | 0x4;

describe('a shared device', () => {
  gpuTest('is one that nothing else uses', async () => {
    const [first, second] = [await shareTestDevice(), await shareTestDevice()];
    expect(first.queue).not.toBe(second.queue);
    first.destroy();
    const third = await shareTestDevice();
    expect(third).not.toBe(first);
    expect(third.queue).toBe(first.queue);
    // Destroying it again takes nothing from who has it now.
    first.destroy();
    const fourth = await shareTestDevice();
    expect(fourth.queue).not.toBe(third.queue);
    for (const device of [second, third, fourth]) device.destroy();
  });

  gpuTest('has the features and limits that were asked for', async () => {
    const adapter = await sharedTestGpu.requestAdapter();
    const { maxBufferSize } = adapter.limits;
    const large = await adapter.requestDevice({ requiredLimits: { maxBufferSize } });
    expect(large.limits.maxBufferSize).toBe(maxBufferSize);
    large.destroy();
    const plain = await shareTestDevice();
    expect(plain.queue).not.toBe(large.queue);
    expect(plain).toBeInstanceOf(GPUDevice);
    plain.destroy();
  });

  gpuTest('passes on nothing that a test has left on it', async () => {
    const device = await shareTestDevice();
    const buffer = device.createBuffer({ size: 16, usage: USAGE });
    const heard: string[] = [];
    device.addEventListener('uncapturederror', ({ error }) => heard.push(error.message));
    device.pushErrorScope('validation');
    vi.spyOn(device, 'createBuffer').mockReturnValue(buffer);
    expect(device.createBuffer({ size: 32, usage: USAGE })).toBe(buffer);
    device.destroy();
    expect((await device.lost).reason).toBe('destroyed');

    const next = await shareTestDevice();
    expect(next.queue).toBe(device.queue);
    const other = next.createBuffer({ size: 32, usage: USAGE });
    expect(other.size).toBe(32);
    // The buffer of before was destroyed, which the scope of before does not hide.
    next.pushErrorScope('validation');
    next.queue.writeBuffer(buffer, 0, new Uint32Array(4));
    // Nor does its last user pop a scope of the next one.
    expect(await device.popErrorScope()).toBeNull();
    const error = await next.popErrorScope();
    expect(error?.message).toContain('destroyed');
    expect(heard).toEqual([]);
    next.destroy();
  });

  gpuTest.fails('fails the test that makes an error on it', async () => {
    const device = await shareTestDevice();
    device.createBuffer({ size: 16, usage: 0 });
  });
});
