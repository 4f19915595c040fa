import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS, SCAN_RUN, SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { CullParameters, PagePlan } from '../../data/layout/structs.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { prefixScan } from '../cull/cull.reference.ts';
import { dispatchSize } from '../dispatch.ts';
import { planProject as planReference } from './project.reference.ts';
import { planProject } from './project.ts';

const gpu = testGpu();

const isFull = process.env.WEBSPLATTER_FULL === '1';

const GARBAGE = 0xdeadbeef;

interface Frame {
  readonly pageCount: number;
  /** Largest number of visible chunks of each page. */
  readonly maxSlots: number;
  readonly dispatchRow: number;
  /** Default room for all. */
  readonly visibleCapacity?: number;
  /** Visible chunks of each page; default: up to `maxSlots`. */
  readonly slotCounts?: readonly number[];
  readonly isNarrow?: boolean;
}

/** Contents of the buffers after the stage, and the contents that the reference expects. */
async function run(frame: Frame, pipelines = gpu.pipelines) {
  const { pageCount, maxSlots, dispatchRow, visibleCapacity = 2 ** 31, isNarrow = false } = frame;
  const random = seededRandom(pageCount + maxSlots);
  const { slotCounts = Array.from({ length: pageCount }, () => Math.floor((maxSlots + 1) * random())) } =
    frame;
  const slotStarts = prefixScan(slotCounts);
  const slotCount = slotStarts[pageCount];
  const pages = slotCounts.map((count, page) => ({ slotStart: slotStarts[page], slotCount: count }));
  // All, some or none of the splats of a visible chunk are visible.
  const splatCounts = Array.from(
    { length: slotCount },
    (_, slot) => [0, CHUNK_SPLATS, Math.floor(CHUNK_SPLATS * random())][slot % 3],
  );
  const plansOf = (splats: readonly { visibleStart: number; visibleCount: number }[]) => {
    const plans = new ArrayBuffer(pageCount * PagePlan.bytes);
    for (const [page, { visibleStart, visibleCount }] of splats.entries()) {
      const chunks = { chunkStart: GARBAGE, chunkEnd: GARBAGE };
      const visible = { visibleStart: visibleStart, visibleCount: visibleCount };
      PagePlan.write(plans, { ...chunks, ...pages[page], ...visible }, page * PagePlan.bytes);
    }
    return new Uint32Array(plans);
  };
  const garbage = (words: number) => gpu.storage(new Uint32Array(words).fill(GARBAGE));
  const parameters = CullParameters.pack({
    chunkCount: slotCount + 3,
    pageCount,
    visibleCapacity,
    dispatchRow,
  });
  const written = {
    pagePlans: gpu.storage(plansOf(pages.map(() => ({ visibleStart: GARBAGE, visibleCount: GARBAGE })))),
    visibleCount: garbage(1),
    projectDispatches: garbage(3 * (pageCount + 1)),
    drawArguments: garbage(4),
    depthSortPlan: garbage(2),
    depthSortDispatch: garbage(3),
    // Sums of an earlier frame follow.
    splatOffsets: gpu.storage([...splatCounts, GARBAGE, GARBAGE, GARBAGE]),
  };
  const bindings = {
    cullParameters: gpu.uniform(parameters),
    slotCount: gpu.storage([slotCount]),
    ...written,
  };
  const sort = { workgroup: 32, itemsPerThread: 3, isNarrow };
  await gpu.run(planProject(sort), bindings, [1, 1, 1], pipelines);
  const { splats, visibleCount, workgroups } = planReference(splatCounts, pages, visibleCapacity);
  const blockCount = Math.ceil(visibleCount / (isNarrow ? 3 : 96));
  const actual: Record<string, Uint32Array> = {};
  for (const [name, buffer] of Object.entries(written)) actual[name] = await gpu.read(buffer);
  const dispatches = [...workgroups, Math.ceil(visibleCount / SHADER_CONSTANTS.TILE_COUNT_BLOCK)];
  const expected = {
    pagePlans: plansOf(splats),
    visibleCount: Uint32Array.of(visibleCount),
    projectDispatches: Uint32Array.from(dispatches.flatMap((count) => dispatchSize(count, dispatchRow))),
    drawArguments: Uint32Array.of(4, visibleCount, 0, 0),
    depthSortPlan: Uint32Array.of(visibleCount, blockCount),
    depthSortDispatch: Uint32Array.from(dispatchSize(blockCount, dispatchRow)),
    splatOffsets: Uint32Array.from([...prefixScan(splatCounts), GARBAGE, GARBAGE]),
  };
  return { actual, expected };
}

const { SCAN_WORKGROUP } = SHADER_CONSTANTS;

/** Values of `maxSlots`, `dispatchRow` and `visibleCapacity`: in the first tier, each of them twice or more. */
const FRAMES = isFull
  ? [0, 1, 60].flatMap((maxSlots) =>
      [7, 65_535].flatMap((row) =>
        [undefined, 0, 3000].map((capacity) => [maxSlots, row, capacity] as const),
      ),
    )
  : ([
      [0, 7, undefined],
      [1, 65_535, 0],
      [60, 7, 3000],
      [60, 65_535, undefined],
      [1, 7, 3000],
      [60, 7, 0],
    ] as const);

describe('plan-project', () => {
  for (const isNarrow of [false, true]) {
    const by = isNarrow ? 'one thread' : 'threads together';
    for (const pageCount of [1, 2, SCAN_WORKGROUP, SCAN_WORKGROUP + 1, 2 * SCAN_WORKGROUP + 5]) {
      const name = `${pageCount} pages by ${by}: the reference's splats, dispatches and draw`;
      gpuTest(name, { tags: 'deeper' }, async () => {
        for (const [maxSlots, dispatchRow, visibleCapacity] of FRAMES) {
          const frame = { pageCount, maxSlots, dispatchRow, visibleCapacity, isNarrow };
          const { actual, expected } = await run(frame);
          expect(actual, `${maxSlots} slots, rows of ${dispatchRow}`).toEqual(expected);
        }
      });
    }

    gpuTest(`any number of visible chunks by ${by}`, async () => {
      for (const slots of [0, 1, 7, 8, 255, 256, 257, SCAN_RUN - 1, SCAN_RUN, SCAN_RUN + 1, 100_003]) {
        const frame = { pageCount: 2, slotCounts: [slots, 3], maxSlots: slots, dispatchRow: 7, isNarrow };
        const { actual, expected } = await run(frame);
        expect(actual, `${slots} chunks`).toEqual(expected);
      }
    });
  }

  for (const [flaw, find, replace] of [
    ['a missing workgroup for the last splats', ' + PROJECT_WORKGROUP - 1u', ''],
    ['a missing block for the last keys', ' + SORT_BLOCK - 1u', ''],
    ['a run that forgets the runs before', 'splats += sums.total', 'splats = sums.total'],
  ]) {
    gpuTest(`${flaw} is noticed`, async () => {
      const mutation = { file: 'stages/plan-project', find, replace };
      const frame = { pageCount: 2, slotCounts: [SCAN_RUN, 60], maxSlots: 60, dispatchRow: 65_535 };
      const { actual, expected } = await run(frame, new Pipelines(gpu.device, mutation));
      expect(actual).not.toEqual(expected);
    });
  }
});
