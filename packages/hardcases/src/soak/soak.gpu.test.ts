import { createNodeGpu } from '@websplatter/node';
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { soak } from './soak.ts';

/** Also keeps adapters and devices from being garbage-collected, which Dawn does not survive. */
const gpu = { requestAdapter: async () => (await createNodeGpu()).adapter };
const FRAMES = process.env.WEBSPLATTER_FULL === '1' ? 2000 : 150;
/** Another one soaks otherwise: WEBSPLATTER_SEED=7. */
const seed = Number(process.env.WEBSPLATTER_SEED ?? 1);

describe('a soak', () => {
  gpuTest('leaves nothing behind', { timeout: 600_000 }, async () => {
    const { failures, pictures, steps } = await soak({ gpu, seed, frames: FRAMES });
    expect(failures).toEqual([]);
    expect(pictures).toBe(Math.floor(FRAMES / 20));
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
});
