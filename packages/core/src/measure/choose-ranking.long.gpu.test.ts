import { gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { Pipelines } from '../gpu/pipelines.ts';
import { sortShapeFor } from '../stages/sort-shape.ts';
import { failingDevice } from '../testing/failing-device.ts';
import { byBallots, createSortDevice } from '../testing/sort-device.ts';
import { compareSorts, isFasterByBallots } from './choose-ranking.ts';

let device: GPUDevice;
beforeAll(async () => {
  device = await createSortDevice();
});
afterAll(() => device?.destroy());

const FEW = { keyCount: 3000, sortsPerTurn: 2, turns: 3 };

describe('comparing two sorts', () => {
  gpuTest('gives the times of both, and says that they agree', async (context) => {
    const shape = sortShapeFor(32);
    const other = byBallots(shape, device);
    context.skip(!other || !device.features.has('timestamp-query'), 'no subgroups, or no timestamps');
    const { isSameOrder, medianMs } = await compareSorts(device, new Pipelines(device), [shape, other!], FEW);
    expect(isSameOrder).toBe(true);
    expect(medianMs).toHaveLength(2);
    for (const ms of medianMs) expect(ms).toBeGreaterThan(0);
  });

  gpuTest('says that they do not agree if one is wrong', async (context) => {
    const shape = sortShapeFor(32);
    const other = byBallots(shape, device);
    context.skip(!other || !device.features.has('timestamp-query'), 'no subgroups, or no timestamps');
    const backwards = new Pipelines(device, {
      file: 'stages/sort-scatter',
      find: 'countOf4(peers & before(group.lane))',
      replace: 'countOf4(peers & ~before(group.lane)) - 1u',
    });
    const { isSameOrder } = await compareSorts(device, backwards, [shape, other!], {
      ...FEW,
      keyCount: 70_000,
    });
    expect(isSameOrder).toBe(false);
  });
});

gpuTest(
  'any allocation of a comparison may find no memory: it rejects, and so it does above a budget',
  async (context) => {
    context.skip(!device.features.has('timestamp-query'), 'no timestamps');
    const failing = failingDevice(device);
    const pipelines = new Pipelines(device);
    const shape = sortShapeFor(32);
    const compare = (availableBytes?: number) =>
      compareSorts(failing.device, pipelines, [shape, shape], { ...FEW, availableBytes });
    await expect(compare(10_000)).rejects.toMatchObject({ limit: 'memoryBudgetBytes' });
    let failures = 0;
    for (let hasFailed = true; hasFailed; failures++) {
      failing.failAfter(failures);
      const lack = await compare().then(
        () => null,
        (error) => error,
      );
      hasFailed = failing.stop();
      if (hasFailed) expect(lack).toMatchObject({ name: 'GpuLimitError', limit: 'memory' });
      else expect(lack).toBeNull();
    }
    expect(failures).toBeGreaterThan(10);
  },
);

gpuTest('where no block suits ballots, nothing is measured', async () => {
  const ballots = { min: 4, max: 4, workgroupThreads: 64 };
  expect(await isFasterByBallots(device, new Pipelines(device), ballots)).toBe(false);
});
