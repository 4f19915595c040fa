import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { perspectiveCamera } from '../camera/camera.ts';
import { SplatEngine } from '../engine.ts';
import { GpuLimitError } from '../errors.ts';
import { type FailingDevice, failingDevice } from '../testing/failing-device.ts';
import { randomSplats } from '../testing/random-splats.ts';

const SIZE = { widthPx: 32, heightPx: 32 };
const CAMERA = perspectiveCamera({ position: [0, 0, 5], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });

let failing: FailingDevice;
beforeAll(async () => {
  failing = failingDevice(await createTestDevice());
});
afterAll(() => failing?.device.destroy());

/** Calls `attempt` with one allocation after another failing, until it makes do with those before. */
async function failEach(attempt: () => Promise<void>): Promise<number> {
  for (let n = 0; ; n++) {
    const before = failing.allocations;
    failing.failAfter(n);
    await attempt();
    failing.failAfter(Number.POSITIVE_INFINITY);
    const count = failing.allocations - before;
    if (count <= n) return n;
  }
}

describe('an allocation that fails, whichever it is', () => {
  for (const rasterizer of ['quads', 'tiles'] as const) {
    for (const resolutionScale of [1, 0.5]) {
      gpuTest(`of a frame by ${rasterizer} at scale ${resolutionScale}: the picture before stays`, async () => {
        const { device } = failing;
        const engine = await SplatEngine.create({
          device,
          accuracy: { preset: 'fast', rasterizer, resolutionScale },
        });
        const small = { camera: CAMERA, clouds: [{ cloud: engine.add(randomSplats({ count: 300 })) }], ...SIZE };
        const large = {
          ...small,
          clouds: [{ cloud: engine.add(randomSplats({ count: 700 })) }],
          widthPx: 80,
          heightPx: 48,
        };
        const other = engine.createView();
        other.render(large);
        const expected = await other.readPixels();
        let failures = 0;
        await failEach(async () => {
          const view = engine.createView();
          view.render(small);
          failures += await view.whenDrawn().then(
            () => 0,
            (error) => {
              expect(error).toBeInstanceOf(GpuLimitError);
              return 1;
            },
          );
          view.destroy();
        });
        const view = engine.createView();
        view.render(small);
        const before = await view.readPixels();
        const held = engine.memory();
        await failEach(async () => {
          view.render(large);
          const error = await view.whenDrawn().catch((error) => error);
          if (!error) return;
          failures++;
          expect(error).toBeInstanceOf(GpuLimitError);
          expect(error).toMatchObject({ limit: 'memory', availableBytes: 0 });
          expect(() => view.render(large)).toThrow(GpuLimitError);
          // The picture before is there again, and counted alone.
          expect(view.render(small)).toBe(false);
          expect(await view.readPixels()).toEqual(before);
          expect(engine.memory().totalBytes).toBe(held.totalBytes);
          view.render(large);
          expect(await view.readPixels()).toEqual(expected);
          view.render(small);
          expect(await view.readPixels()).toEqual(before);
        });
        console.log(rasterizer, resolutionScale, 'failures', failures);
        expect(failures).toBeGreaterThan(20);
        engine.destroy();
      });
    }
  }
});
