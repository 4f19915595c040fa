import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { ChunkParameters } from '../layout/packing-structs.ts';
import { Chunk } from '../layout/structs.ts';
import { packGeometry } from '../packing/geometry.ts';
import { chunkCountOf } from '../packing/packed-cloud.ts';
import type { GeometryPrecision } from '../packing/precision.ts';
import { ingestChunks as reference } from '../reference/ingest-chunks.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { expectSameChunks } from '../testing/expect-same-planes.ts';
import { runStage, storageBuffer, uniformBuffer } from '../testing/gpu-buffers.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { dispatchSize } from './dispatch.ts';
import { ingestChunks } from './ingest-chunks.ts';

const DISPATCH_ROW = 2;

let device: GPUDevice;
let pipelines: Pipelines;
beforeAll(async () => {
  device = await shareTestDevice();
  pipelines = new Pipelines(device);
});
afterAll(() => device.destroy());

async function chunksOf(set: SplatSet, precision: GeometryPrecision, shaders = pipelines) {
  const { words, logScaleRange } = packGeometry(set, precision);
  const chunks = storageBuffer(device, [], Chunk.bytes * chunkCountOf(set.count));
  const logScales = [logScaleRange.min, logScaleRange.step];
  const parameters = ChunkParameters.pack({ logScales, splatCount: set.count, dispatchRow: DISPATCH_ROW });
  const bindings = {
    parameters: uniformBuffer(device, parameters),
    geometry: storageBuffer(device, words),
    chunks,
  };
  const size = dispatchSize(chunkCountOf(set.count), DISPATCH_ROW);
  await runStage(device, shaders, ingestChunks(precision), bindings, size);
  return (await readWords(device, chunks)).buffer;
}

describe('ingest-chunks', () => {
  for (const count of [1, 256, 257, 1500]) {
    for (const precision of ['packed', 'f32'] as const) {
      gpuTest(`${count} splats, ${precision}: bounds are exact, scales to a step`, async () => {
        const set = randomSplats({ count, seed: count, shDegree: 0, logScales: [-30, 30] });
        set.positions.set([-0, 1e-42, -3e38]);
        expectSameChunks(await chunksOf(set, precision), reference(set));
      });
    }
  }

  gpuTest('a bound that is not exact is noticed', async () => {
    const set = randomSplats({ count: 300, seed: 1, shDegree: 0 });
    const mutation = { file: 'stages/ingest-chunks', find: 'let ordered = ', replace: 'let ordered = 1u + ' };
    const chunks = await chunksOf(set, 'packed', new Pipelines(device, mutation));
    expect(() => expectSameChunks(chunks, reference(set))).toThrow();
  });
});
