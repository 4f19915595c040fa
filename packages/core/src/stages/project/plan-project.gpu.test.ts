import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { CullParameters, PagePlan } from '../../data/layout/structs.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { prefixScan } from '../cull/cull.reference.ts';
import { dispatchSize } from '../dispatch.ts';
import { planProject as planReference } from './project.reference.ts';
import { planProject } from './project.ts';

const gpu = testGpu();

const GARBAGE = 0xdeadbeef;

interface Frame {
  readonly pageCount: number;
  /** Largest number of visible chunks of each page. */
  readonly maxSlots: number;
  readonly dispatchRow: number;
  /** Default room for all. */
  readonly visibleCapacity?: number;
}

/** Contents of the buffers after the stage, and the contents that the reference expects. */
async function run(
  { pageCount, maxSlots, dispatchRow, visibleCapacity = 2 ** 31 }: Frame,
  pipelines = gpu.pipelines,
) {
  const random = seededRandom(pageCount + maxSlots);
  const slotCounts = Array.from({ length: pageCount }, () => Math.floor((maxSlots + 1) * random()));
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
  };
  const bindings = {
    cullParameters: gpu.uniform(parameters),
    // Sums of an earlier frame follow.
    splatOffsets: gpu.storage([...prefixScan(splatCounts), GARBAGE, GARBAGE]),
    slotCount: gpu.storage([slotCount]),
    ...written,
  };
  await gpu.run(planProject, bindings, [1, 1, 1], pipelines);
  const { splats, visibleCount, workgroups } = planReference(splatCounts, pages, visibleCapacity);
  const actual: Record<string, number[]> = {};
  for (const [name, buffer] of Object.entries(written)) actual[name] = [...(await gpu.read(buffer))];
  const expected = {
    pagePlans: [...plansOf(splats)],
    visibleCount: [visibleCount],
    projectDispatches: [...workgroups, Math.ceil(visibleCount / SHADER_CONSTANTS.TILE_COUNT_BLOCK)].flatMap(
      (count) => dispatchSize(count, dispatchRow),
    ),
    drawArguments: [4, visibleCount, 0, 0],
  };
  return { actual, expected };
}

const { PLAN_WORKGROUP } = SHADER_CONSTANTS;

describe('plan-project', () => {
  for (const pageCount of [1, 2, PLAN_WORKGROUP, PLAN_WORKGROUP + 1, 3 * PLAN_WORKGROUP + 5]) {
    gpuTest(`${pageCount} pages: the reference's splats, dispatches and draw`, async () => {
      for (const maxSlots of [0, 1, 60]) {
        for (const dispatchRow of [7, 65_535]) {
          for (const visibleCapacity of [undefined, 0, 3000]) {
            const { actual, expected } = await run({ pageCount, maxSlots, dispatchRow, visibleCapacity });
            expect(actual).toEqual(expected);
          }
        }
      }
    });
  }

  gpuTest('a missing workgroup for the last splats is noticed', async () => {
    const mutation = { file: 'stages/plan-project', find: ' + PROJECT_WORKGROUP - 1u', replace: '' };
    const frame = { pageCount: 2, maxSlots: 60, dispatchRow: 7 };
    const { actual, expected } = await run(frame, new Pipelines(gpu.device, mutation));
    expect(actual).not.toEqual(expected);
  });
});
