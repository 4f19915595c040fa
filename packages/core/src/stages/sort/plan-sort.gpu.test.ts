import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SortParameters } from '../../data/layout/structs.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { planSort as planReference } from './sort.reference.ts';
import { blockKeysOf, planSort, sortShapeFor } from './sort.ts';

const gpu = testGpu();

interface Keys {
  readonly keyBits: number;
  readonly keyCount: number;
  readonly capacity: number;
  readonly dispatchRow: number;
}

/** Contents of the buffers after the stage, and the contents that the reference expects. */
async function run({ keyBits, keyCount, capacity, dispatchRow }: Keys, pipelines = gpu.pipelines) {
  const blockKeys = blockKeysOf(sortShapeFor(keyBits));
  const pass = { digitShift: 0, makesPayloads: 0, writesKeys: 0, scanLanes: 0 };
  const parameters = SortParameters.pack({ ...pass, capacity, dispatchRow });
  const garbage = (words: number) => gpu.storage(new Uint32Array(words).fill(0xdeadbeef));
  const written = { plan: garbage(2), blockDispatch: garbage(3) };
  const bindings = {
    parameters: gpu.uniform(parameters),
    keyCount: gpu.storage([keyCount]),
    ...written,
  };
  await gpu.run(planSort(blockKeys), bindings, [1, 1, 1], pipelines);
  const actual: Record<string, number[]> = {};
  for (const [name, buffer] of Object.entries(written)) actual[name] = [...(await gpu.read(buffer))];
  const reference = planReference(keyCount, { capacity, blockKeys });
  const expected = {
    plan: [reference.keyCount, reference.blockCount],
    blockDispatch: dispatchSize(reference.blockCount, dispatchRow),
  };
  return { actual, expected };
}

describe('plan-sort', () => {
  for (const keyBits of [24, 27, 32]) {
    gpuTest(`keys of ${keyBits} bits: the reference's blocks and dispatch`, async () => {
      const block = blockKeysOf(sortShapeFor(keyBits));
      for (const keyCount of [0, 1, block - 1, block, block + 1, 7 * block, 7 * block + 1, 1_000_003]) {
        for (const capacity of [keyCount, keyCount + 5000, Math.ceil(keyCount / 2)]) {
          for (const dispatchRow of [7, 65_535]) {
            const { actual, expected } = await run({ keyBits, keyCount, capacity, dispatchRow });
            expect(actual).toEqual(expected);
          }
        }
      }
    });
  }

  gpuTest('keys beyond the capacity of the buffers are noticed', async () => {
    const mutation = {
      file: 'stages/plan-sort',
      find: 'min(keyCount, parameters.capacity)',
      replace: 'keyCount',
    };
    const keys = { keyBits: 32, keyCount: 5000, capacity: 4000, dispatchRow: 7 };
    const { actual, expected } = await run(keys, new Pipelines(gpu.device, mutation));
    expect(actual).not.toEqual(expected);
  });
});
