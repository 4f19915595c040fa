// Proves: levels made in parts equal levels made at once, and end well at any part.
import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import { DestroyedError } from '../../data/errors.ts';
import { packSet } from '../../data/packing/pack-set.ts';
import { followEdits } from '../../features/edits/edits.clouds.ts';
import { SplatEdits } from '../../features/edits/splat-edits.data.ts';
import { deviceWith } from '../../testing/device-with.ts';
import { madeLevels } from '../../testing/made-levels.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import type { SplatCloud } from '../splat-cloud.ts';

/** Less than any submission takes: all levels are made in as many as there are cells. */
const LEAST_BUDGET_MS = 1e-3;
const CELLS = 9;
const SET = randomSplats({ count: 2000, seed: 3, shDegree: 1 });
const gpu = testGpu();

/** An engine on `whole` that calls `onSubmitted` after each submission that makes levels. */
function engineOn(whole: GPUDevice, onSubmitted: (submissions: number) => void): Promise<SplatEngine> {
  let submissions = 0;
  const createCommandEncoder = (descriptor?: GPUCommandEncoderDescriptor) => {
    // Submitted before any microtask runs.
    if (descriptor?.label?.endsWith('levels')) queueMicrotask(() => onSubmitted(++submissions));
    return whole.createCommandEncoder(descriptor);
  };
  const device = deviceWith(whole, { createCommandEncoder });
  return SplatEngine.create({ device, accuracy: 'reference', submissionBudgetMs: LEAST_BUDGET_MS });
}

describe('levels that are made in parts', () => {
  gpuTest('are those that one submission makes, bit for bit', async () => {
    const packed = packSet(SET, { geometryPrecision: 'f32', shPrecision: 'f32' });
    const [bytesPerPage, submissionBudgetMs] = [64 * 256 * 3, LEAST_BUDGET_MS];
    const inParts = await madeLevels(gpu, packed, { bytesPerPage, submissionBudgetMs });
    expect(inParts).toEqual(await madeLevels(gpu, packed));
  });

  /**
   * @fault Time: making levels of detail would keep a slow GPU for seconds
   * @consequence levels are made in parts, the page runs before each, and the result is the same, bit for
   *   bit
   */
  gpuTest('let the page run before each', async () => {
    let tasks = 0;
    const tasksBefore: number[] = [];
    const engine = await engineOn(gpu.device, () => {
      tasksBefore.push(tasks);
      setImmediate(() => tasks++);
    });
    const cloud = engine.add(SET);
    await cloud.makeLevels();
    expect(tasksBefore.length).toBe(CELLS);
    expect(new Set(tasksBefore).size).toBe(CELLS);
    // The last lies above all others.
    const levels = Array.from({ length: CELLS }, (_, cell) => cloud.levels!.levelOf(cell));
    expect(levels).toEqual([...levels.slice(1).fill(0), 1]);
    engine.destroy();
  });

  const ends: Record<string, (cloud: SplatCloud, engine: SplatEngine) => unknown> = {
    'the cloud is destroyed': (cloud) => cloud.destroy(),
    'the engine ends': (_, engine) => engine.destroy(),
    'the device is lost': (_, { device }) => device.destroy(),
  };
  for (const [what, end] of Object.entries(ends)) {
    /**
     * @fault Time: cloud, engine or device end while levels are made
     * @consequence the other parts are left out, nothing stays allocated, `makeLevels` rejects
     */
    gpuTest(`end midway where ${what}, and leave nothing`, async () => {
      // The others leave the device, and the shaders that it has compiled.
      const device = what === 'the device is lost' ? await createTestDevice() : gpu.device;
      let submissions = 0;
      const engine = await engineOn(device, (count) => {
        submissions = count;
        if (count === 3) end(cloud, engine);
      });
      const cloud = engine.add(SET);
      const { totalBytes } = engine.memory();
      await expect(cloud.makeLevels()).rejects.toThrow(DestroyedError);
      expect(submissions).toBeLessThan(CELLS);
      expect(cloud.levels).toBeNull();
      expect(engine.memory().totalBytes).toBeLessThanOrEqual(totalBytes);
      engine.destroy();
    });
  }

  /**
   * @fault Time: a cloud is edited while its levels are made
   * @consequence edited splats are drawn one by one
   */
  gpuTest('leave rows to cuts that are edited meanwhile, and hold all edits before', async () => {
    const edits = new SplatEdits();
    const engine = await engineOn(gpu.device, (count) => {
      if (count === 3) edits.set([7], { visible: false });
    });
    const cloud = engine.add(SET);
    edits.set([5, 6], { visible: false });
    await followEdits(cloud, edits);
    await cloud.makeLevels();
    const { edited, hidden } = cloud.features[0].touched!;
    const splatsOf = (bits: Uint32Array) =>
      Array.from(cloud.fileIndices).filter((_, i) => (bits[i >>> 5] >>> i) & 1);
    expect(splatsOf(edited)).toEqual([7]);
    expect(splatsOf(hidden)).toEqual([7]);
    // Taken back, what levels show as edited is drawn one by one.
    edits.reset([5, 7]);
    expect(splatsOf(edited)).toEqual([5]);
    expect(splatsOf(hidden)).toEqual([]);
    const { levels } = cloud;
    await cloud.makeLevels();
    expect(cloud.levels).not.toBe(levels);
    expect(splatsOf(edited)).toEqual([]);
    const anew = cloud.levels;
    await cloud.makeLevels();
    expect(cloud.levels).toBe(anew);
    engine.destroy();
  });

  /**
   * @fault Time: a lease frees the planes that levels are made of
   * @consequence levels are rebuilt from the remaining planes
   */
  gpuTest('are made anew where the planes that they are made of are freed', async () => {
    let submissions = 0;
    const engine = await engineOn(gpu.device, (count) => {
      submissions = count;
      if (count === 3) cloud.ownLease.release();
    });
    const cloud = engine.add(SET);
    await cloud.hold({ geometryPrecision: 'packed', shPrecision: 'u8' }).met;
    await cloud.makeLevels();
    expect(submissions).toBe(3 + CELLS);
    expect(cloud.precisions.geometry).toEqual(['packed']);
    engine.destroy();
  });
});
