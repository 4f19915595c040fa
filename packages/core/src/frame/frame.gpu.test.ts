import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { PagePlan } from '../data/layout/structs.ts';
import type { DispatchSize, DrawSize, FramePass } from '../gpu/passes.ts';
import { InspectedFrame } from '../inspect/inspected-frame.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { testCameras } from '../testing/test-cameras.ts';
import { totalChunks } from './frame-pages.ts';

describe('a frame', () => {
  gpuTest('plans the work of each page on the GPU, and lists the visible splats without gaps', async () => {
    const device = await shareTestDevice();
    const dispatchRow = 3;
    const frame = await InspectedFrame.draw(device, {
      clouds: [
        { set: randomSplats({ count: 256 * 14 + 9, shDegree: 0, halfExtent: 3 }), splatsPerPage: 256 * 4 },
        { set: randomSplats({ count: 10, shDegree: 0, seed: 2, opacityLogits: [-9, -8] }) },
        { set: randomSplats({ count: 700, shDegree: 0, seed: 3 }) },
      ],
      camera: testCameras(1).telephoto,
      widthPx: 32,
      heightPx: 32,
      dispatchRow,
      keyBits: 8,
    });
    const { pages } = frame.parts;
    const chunkCount = totalChunks(pages);
    expect(pages.map((page) => page.chunkCount)).toEqual([4, 4, 4, 3, 1, 3]);
    const chunkOffsets = await frame.words('chunkOffsets');
    const visibleChunks = await frame.words('visibleChunks');
    const visibleSplats = await frame.words('visibleSplats');
    const plans = await frame.words('pagePlans');
    const cullDispatches = await frame.words('cullDispatches');
    const projectDispatches = await frame.words('projectDispatches');
    let slots = 0;
    let drawn = 0;
    for (const [index, page] of pages.entries()) {
      const [chunkStart, chunkEnd, slotStart, slotCount, visibleStart, visibleCount] = plans.subarray(
        (PagePlan.bytes / 4) * index,
      );
      expect([chunkStart, chunkEnd]).toEqual([page.chunkStart, page.chunkStart + page.chunkCount]);
      expect(slotStart).toBe(slots);
      expect(visibleStart).toBe(drawn);
      const isOfPage = (chunk: number) => chunk >= chunkStart && chunk < chunkEnd;
      expect(visibleChunks.subarray(slotStart, slotStart + slotCount).every(isOfPage)).toBe(true);
      for (const splat of visibleSplats.subarray(visibleStart, visibleStart + visibleCount))
        expect(isOfPage(Math.floor(splat / 256))).toBe(true);
      expect(Array.from(cullDispatches.subarray(3 * index, 3 * index + 3))).toEqual(
        dispatchSize(slotCount, dispatchRow),
      );
      expect(Array.from(projectDispatches.subarray(3 * index, 3 * index + 3))).toEqual(
        dispatchSize(Math.ceil(visibleCount / 256), dispatchRow),
      );
      slots += slotCount;
      drawn += visibleCount;
    }
    expect(slots).toBe(chunkOffsets[chunkCount]);
    expect((await frame.words('slotCount'))[0]).toBe(slots);
    expect(Array.from(cullDispatches.subarray(3 * pages.length))).toEqual(dispatchSize(slots, dispatchRow));
    expect(drawn).toBe(await frame.visibleCount());
    expect(drawn).toBeGreaterThan(0);
    // The faint cloud has a page in which nothing is drawn.
    expect(plans[(PagePlan.bytes / 4) * 4 + 5]).toBe(0);
    frame.destroy();
    device.destroy();
  });
});

/** Prints passes, each with its pipelines and the sizes of their dispatches or draws. */
function printed(passes: readonly FramePass[]): string[] {
  const sizeOf = (size: DispatchSize | DrawSize) =>
    'buffer' in size ? 'as counted' : size.join(' × ').replace(/( × 1)+$/, '');
  return passes.flatMap((pass) => {
    const commands =
      'dispatches' in pass
        ? pass.dispatches.map(({ pipeline, size }) => `${pipeline.label}: ${sizeOf(size)}`)
        : pass.draws.map((size) => `${pass.pipeline.label}: ${sizeOf(size)}`);
    return [pass.label, ...commands.map((command) => `  ${command}`)];
  });
}

describe('the passes of a frame', () => {
  /** Prints the passes of a frame of two small clouds, as on devices whose subgroups are wide. */
  async function passesBy(rasterizer: 'tiles' | 'quads', resolutionScale: number) {
    const device = await shareTestDevice();
    const frame = await InspectedFrame.draw(device, {
      clouds: [700, 300].map((count) => ({ set: randomSplats({ count, shDegree: 0 }) })),
      camera: testCameras(1).perspective,
      accuracy: { rasterizer, resolutionScale },
      widthPx: 64,
      heightPx: 64,
      keyBits: 8,
      isNarrow: false,
    });
    const { parts } = frame;
    const lines = printed([...parts.orderPasses, ...parts.drawPasses({ kind: 'image' })]);
    frame.destroy();
    device.destroy();
    return lines;
  }

  const FIND_AND_SORT = [
    'pre-process',
    '  cull-chunks cullChunks: 1',
    '  cull-chunks cullChunks: 1',
    '  plan-cull planCull: 1',
    '  cull-splats cullSplats: 3',
    '  cull-splats cullSplats: 2',
    '  plan-project planProject: 1',
    '  compact-splats compactSplats: 5',
    '  project project: 3',
    '  project project: 2',
    'sort',
    '  sort-histogram sortHistogram: 1',
    '  sort-scan sortScan: 1',
    '  sort-scatter sortScatter: 1',
  ];

  gpuTest('by quads', async () => {
    expect(await passesBy('quads', 1)).toEqual([...FIND_AND_SORT, 'rasterize', '  rasterize: as counted']);
  });

  gpuTest('by tiles, in a smaller layer', async () => {
    expect(await passesBy('tiles', 0.5)).toEqual([
      ...FIND_AND_SORT,
      'tile lists',
      '  tile-count tileCount: 1',
      '  tile-plan planTiles: 1',
      '  tile-count tileCount: 1',
      '  tile-plan planTiles: 1',
      '  tile-emit tileEmit: 6',
      '  sort-scan sortScan: 1',
      '  sort-scatter sortScatter: 6',
      '  tile-ranges tileRanges: 1',
      '  tile-masks maskTiles: 64',
      'tiles',
      '  tile-rasterize tileRasterize: 64',
      '  tile-rest tileRest: 64',
      'rasterize',
      '  rasterize: as counted',
      'upscale',
      '  upscale upscale: 8 × 8',
    ]);
  });
});
