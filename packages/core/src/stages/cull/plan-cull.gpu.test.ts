import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { CullParameters, PagePlan } from '../../data/layout/structs.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { planCull as planReference, prefixScan } from './cull.reference.ts';
import { planCull } from './cull.ts';

const gpu = testGpu();

const GARBAGE = 0xdeadbeef;

interface Frame {
  readonly pageCount: number;
  /** Share of the chunks that is visible. */
  readonly visiblePart: number;
  readonly dispatchRow: number;
}

/** Contents of the buffers after the stage, and the contents that the reference expects. */
async function run({ pageCount, visiblePart, dispatchRow }: Frame, pipelines = gpu.pipelines) {
  const random = seededRandom(pageCount + visiblePart);
  const chunkCounts = Array.from({ length: pageCount }, () => 1 + Math.floor(40 * random()));
  const chunkStarts = prefixScan(chunkCounts);
  const pages = chunkCounts.map((_, page) => ({
    chunkStart: chunkStarts[page],
    chunkEnd: chunkStarts[page + 1],
  }));
  const chunkCount = chunkStarts[pageCount];
  const flags = Array.from({ length: chunkCount }, () => (random() < visiblePart ? 1 : 0));
  const plansOf = (slots: readonly { slotStart: number; slotCount: number }[]) => {
    const plans = new ArrayBuffer(pageCount * PagePlan.bytes);
    for (const [page, chunks] of pages.entries()) {
      const later = { visibleStart: GARBAGE, visibleCount: GARBAGE };
      PagePlan.write(plans, { ...chunks, ...slots[page], ...later }, page * PagePlan.bytes);
    }
    return new Uint32Array(plans);
  };
  const garbage = (words: number) => gpu.storage(new Uint32Array(words).fill(GARBAGE));
  const parameters = CullParameters.pack({ chunkCount, pageCount, visibleCapacity: 0, dispatchRow });
  const written = {
    pagePlans: gpu.storage(plansOf(pages.map(() => ({ slotStart: GARBAGE, slotCount: GARBAGE })))),
    slotCount: garbage(1),
    cullDispatches: garbage(3 * (pageCount + 1)),
    depthRange: garbage(2),
  };
  const bindings = {
    cullParameters: gpu.uniform(parameters),
    chunkOffsets: gpu.storage(prefixScan(flags)),
    ...written,
  };
  await gpu.run(planCull, bindings, [1, 1, 1], pipelines);
  const { slots, slotCount, workgroups } = planReference(flags, pages);
  const actual: Record<string, number[]> = {};
  for (const [name, buffer] of Object.entries(written)) actual[name] = [...(await gpu.read(buffer))];
  const expected = {
    pagePlans: [...plansOf(slots)],
    slotCount: [slotCount],
    cullDispatches: workgroups.flatMap((count) => dispatchSize(count, dispatchRow)),
    depthRange: [0, 0],
  };
  return { actual, expected };
}

const { PLAN_WORKGROUP } = SHADER_CONSTANTS;

describe('plan-cull', () => {
  for (const pageCount of [1, 2, PLAN_WORKGROUP, PLAN_WORKGROUP + 1, 3 * PLAN_WORKGROUP + 5]) {
    gpuTest(`${pageCount} pages: the reference's slots and dispatches`, async () => {
      for (const visiblePart of [0, 0.3, 1]) {
        for (const dispatchRow of [7, 65_535]) {
          const { actual, expected } = await run({ pageCount, visiblePart, dispatchRow });
          expect(actual).toEqual(expected);
        }
      }
    });
  }

  gpuTest('a thread that plans only its first page is noticed', async () => {
    const mutation = { file: 'stages/plan-cull', find: 'page += PLAN_WORKGROUP', replace: 'page += 1000u' };
    const frame = { pageCount: PLAN_WORKGROUP + 1, visiblePart: 1, dispatchRow: 7 };
    const { actual, expected } = await run(frame, new Pipelines(gpu.device, mutation));
    expect(actual).not.toEqual(expected);
  });
});
