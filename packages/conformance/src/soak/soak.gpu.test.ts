// Proves: hundreds of frames, loads and losses leave nothing, and no bit differs.
import { createNodeGpu } from '@websplatter/node';
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { soak } from './soak.ts';

/** Also keeps adapters and devices from being garbage-collected, which Dawn does not survive. */
const gpu = { requestAdapter: async () => (await createNodeGpu()).adapter };
/** Nearly all of their time goes to compiling shaders for new settings: comparing more often costs little. */
const FRAMES = 450;
const COMPARE_EVERY = 9;
/** Another one soaks otherwise: WEBSPLATTER_SEED=7. */
const seed = Number(process.env.WEBSPLATTER_SEED ?? 1);

/** Adapters whose devices are put on a list. */
function keeping(devices: GPUDevice[]): Pick<GPU, 'requestAdapter'> {
  return {
    requestAdapter: async () => {
      const adapter = await gpu.requestAdapter();
      const requestDevice = adapter.requestDevice.bind(adapter);
      adapter.requestDevice = async (descriptor) => {
        const device = await requestDevice(descriptor);
        devices.push(device);
        return device;
      };
      return adapter;
    },
  };
}

describe('a soak', () => {
  /**
   * @fault Devices and engines: hundreds of frames, loads and losses
   * @consequence memory is back where it was; images equal those of a fresh engine, bit for bit
   */
  gpuTest('leaves nothing behind', { timeout: 600_000 }, async () => {
    const { failures, pictures, steps, gpuBytes } = await soak({
      gpu,
      seed,
      frames: FRAMES,
      compareEvery: COMPARE_EVERY,
    });
    expect(failures).toEqual([]);
    expect(gpuBytes.most).toBeGreaterThan(0);
    expect(gpuBytes.atRest).toBe(0);
    expect(pictures).toBe(Math.floor(FRAMES / COMPARE_EVERY));
    expect(steps['lose the device']).toBeGreaterThan(0);
  });

  gpuTest('notices a picture that differs in one bit, and says where', async () => {
    const doctor = (picture: Float32Array) => {
      new Uint32Array(picture.buffer)[4] ^= 1;
    };
    const { failures } = await soak({ gpu, seed: 3, frames: 20, compareEvery: 5, doctor });
    expect(failures).toHaveLength(1);
    expect(failures[0]).toMatch(/^seed 3, frame 5 \(.+\): column \d+, row \d+, channel 0: got /);
  });

  gpuTest('notices a device that is lost by itself, and ends with the frame', async () => {
    const devices: GPUDevice[] = [];
    const onFrame = (frame: number) => {
      if (frame === 3) devices[0].destroy();
    };
    const { failures, steps } = await soak({ gpu: keeping(devices), seed: 3, frames: 20, onFrame });
    expect(failures.join('\n')).toMatch(/^seed 3, frame 4 \(.+\): the device was lost \(destroyed\)/m);
    expect(Object.values(steps).reduce((sum, count) => sum + count, 0)).toBe(4);
  });

  gpuTest('notices that there is no device after a loss', async () => {
    let adapters = 1;
    const scarce = { requestAdapter: async () => (adapters-- > 0 ? gpu.requestAdapter() : null) };
    // The seed's first step is a loss.
    const { failures } = await soak({ gpu: scarce, seed: 32, frames: 1 });
    expect(failures).toEqual([
      expect.stringMatching(/^seed 32, frame 1 \(lose the device\): WebGpuUnavailableError: /),
    ]);
  });

  gpuTest('notices that JavaScript objects take ever more memory', async () => {
    const growingBy = (mib: number) => {
      const values = [2 ** 20, (1 + mib) * 2 ** 20];
      return { gpu, seed: 3, frames: 1, heapBytes: () => values.shift() ?? 0 };
    };
    const sound = await soak(growingBy(15));
    expect(sound).toMatchObject({ failures: [], heapBytes: { early: 2 ** 20, end: 2 ** 24 } });
    const { failures } = await soak(growingBy(17));
    expect(failures).toEqual([
      'seed 3, frame 1 (end): JavaScript objects take 18874368 bytes, 1048576 after a tenth of the frames',
    ]);
  });
});
