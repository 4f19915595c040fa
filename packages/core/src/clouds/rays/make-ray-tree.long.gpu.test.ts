// Proves: rays hit splats read back from the GPU as those in memory.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { createEngine, type SplatEngine } from '../../create-engine.ts';
import { DestroyedError, SplatSourceError } from '../../data/errors.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import { encodePly } from '../../io/formats/ply/write-ply.ts';
import { deviceWith, limitsWith } from '../../testing/device-with.ts';
import { movingSplats } from '../../testing/moving-splats.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { makeRayTree } from './rays.ts';

const SPLATS = randomSplats({ count: 1500, shDegree: 1, logScales: [-3, -2] });
const FILE = new Blob([encodePly(SPLATS)]);

let device: GPUDevice;
let engine: SplatEngine;
beforeAll(async () => {
  device = await shareTestDevice();
  // Several pages, and rows that are packed on the GPU.
  const limited = deviceWith(device, {
    limits: limitsWith(device, { maxStorageBufferBindingSize: 180 * 512 }),
  });
  engine = await createEngine({ device: limited }, { ingestMinRows: 1 });
});

describe('rays', () => {
  for (const geometryPrecision of ['packed', 'f32'] as const) {
    gpuTest(
      `hit splats that are ${geometryPrecision} on the GPU where they hit those in memory`,
      async () => {
        const packed = packCloud(SPLATS, { geometryPrecision, shPrecision: 'u8' });
        const precision = { geometryPrecision, shPrecision: 'u8' } as const;
        const cloud = await engine.load(FILE, { name: 'rows', precision });
        const trees = await Promise.all([makeRayTree(packed), makeRayTree(cloud)]);
        expect(trees[1].count).toBe(trees[0].count);
        let hits = 0;
        for (let i = 0; i < 200; i++) {
          const angle = 0.31 * i;
          const origin = [4 * Math.cos(angle), Math.sin(3 * angle), 4 * Math.sin(angle)] as const;
          const target = [0.3 * Math.sin(7 * i), 0.3 * Math.cos(5 * i), 0] as const;
          const direction = [target[0] - origin[0], target[1] - origin[1], -origin[2]] as const;
          const [inMemory, onGpu] = trees.map((tree) => tree.cast(origin, direction));
          if (!inMemory) continue;
          hits++;
          // The GPU may round a size to the next step.
          expect(onGpu!.distance).toBeCloseTo(inMemory.distance, 2);
        }
        expect(hits).toBeGreaterThan(50);
        cloud.destroy();
      },
    );
  }

  gpuTest('hit moving splats on the GPU, of several pages, where they hit those in memory', async () => {
    const set = movingSplats({ count: 1500, shDegree: 1, logScales: [-3, -2] });
    const packed = packCloud(set, { geometryPrecision: 'packed', shPrecision: 'u8' });
    const cloud = engine.addPacked(packed);
    const trees = await Promise.all([packed, cloud].map((each) => makeRayTree(each, { time: 0.6 })));
    expect(cloud.planes.ranges.length).toBeGreaterThan(1);
    expect(trees[1].count).toBe(trees[0].count);
    let hits = 0;
    for (let i = 0; i < 200; i++) {
      const origin = [4 * Math.cos(i), Math.sin(3 * i), 4 * Math.sin(i)] as const;
      const direction = [-origin[0], -origin[1], -origin[2]] as const;
      const [inMemory, onGpu] = trees.map((tree) => tree.cast(origin, direction));
      expect(onGpu?.distance).toBe(inMemory?.distance);
      if (inMemory) hits++;
    }
    expect(hits).toBeGreaterThan(50);
    cloud.destroy();
  });

  gpuTest('end with a moving cloud by name, whenever it ends', async () => {
    const packed = packCloud(movingSplats({ count: 300 }), {
      geometryPrecision: 'packed',
      shPrecision: 'u8',
    });
    let refused = 0;
    for (let turns = 0; turns < 30; turns++) {
      const cloud = engine.addPacked(packed);
      await cloud.uploaded;
      const ended = makeRayTree(cloud).then(
        () => 'done',
        (error: unknown) => error,
      );
      for (let turn = 0; turn < turns; turn++) await Promise.resolve();
      cloud.destroy();
      const end = await ended;
      if (end === 'done') continue;
      expect(end).toBeInstanceOf(DestroyedError);
      refused++;
    }
    // Splats are read back from the GPU, which takes more than no turn.
    expect(refused).toBeGreaterThan(0);
  });

  gpuTest('wait for previews, and end with their cloud', async () => {
    const refused: Promise<unknown>[] = [];
    const cloud = await engine.load(FILE, {
      onPreview: (preview) => {
        refused.push(makeRayTree(preview).catch((error: unknown) => error));
      },
    });
    expect(refused.length).toBeGreaterThan(0);
    for (const error of await Promise.all(refused)) expect(error).toBeInstanceOf(SplatSourceError);
    const making = makeRayTree(cloud);
    cloud.destroy();
    await expect(making).rejects.toThrow(DestroyedError);
  });
});
