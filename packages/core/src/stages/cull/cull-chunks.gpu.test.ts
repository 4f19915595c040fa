import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { Chunk } from '../../data/layout/structs.ts';
import { maxScaleOf } from '../../data/packing/chunks.ts';
import { InspectedFrame } from '../../inspect/inspected-frame.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import { chunkClearance } from './cull.reference.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';
/** Cameras and models of the first tier: each kind of sides, and models that move them most. */
const SHOWN = ['perspective mirrored', 'perspective sheared', 'inside stretched', 'orthographic stretched'];

/**
 * The shader keeps chunks that fail the test of a side by less than 1e-5 of its terms, and its own
 * rounding of about ten operations on float32 uniforms is below 20 · 2^-24 = 1.2e-6 of them.
 */
const KEPT_BEYOND = 1.2e-5;

describe('cull-chunks', () => {
  const name = 'keeps every chunk that the reference keeps, and none that it clearly drops';
  gpuTest(name, { tags: 'deeper' }, async () => {
    const device = await shareTestDevice();
    const set = randomSplats({ count: 256 * 60 - 100, shDegree: 0, halfExtent: 20, logScales: [-7, -3] });
    let dropped = 0;
    for (const [cameraName, camera] of Object.entries(testCameras(1.5))) {
      for (const [modelName, modelMatrix] of Object.entries(TEST_MODELS)) {
        if (cameraName !== 'perspective' && modelName !== 'stretched') continue;
        if (!isFull && !SHOWN.includes(`${cameraName} ${modelName}`)) continue;
        const clouds = [
          { set, modelMatrix, splatsPerPage: 256 * 25 },
          { set: randomSplats({ count: 300, shDegree: 0, seed: 2 }) },
        ];
        const frame = await InspectedFrame.draw(device, {
          clouds,
          camera,
          widthPx: 24,
          heightPx: 16,
          keyBits: 8,
          dispatchRow: 2,
        });
        const offsets = await frame.words('chunkOffsets');
        let chunk = 0;
        for (const { packed, planes } of frame.clouds) {
          const values = new Float32Array(packed.chunks);
          for (let at = 0; at < values.length; at += Chunk.bytes / 4, chunk++) {
            const clearance = chunkClearance(
              {
                minPosition: values.subarray(at, at + 3),
                maxScale: maxScaleOf(values, at / (Chunk.bytes / 4)),
                maxPosition: values.subarray(at + 4, at + 7),
              },
              planes,
            );
            const isKept = offsets[chunk + 1] > offsets[chunk];
            const place = `${cameraName}, ${modelName}, chunk ${chunk}: clearance ${clearance}`;
            if (clearance >= 0) expect(isKept, place).toBe(true);
            if (clearance < -KEPT_BEYOND) expect(isKept, place).toBe(false);
            if (!isKept) dropped++;
          }
        }
        expect(chunk).toBe(62);
        frame.destroy();
      }
    }
    // Otherwise the test would have compared nothing.
    expect(dropped).toBeGreaterThan(50);
    device.destroy();
  });
});
