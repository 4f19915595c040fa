import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SCAN_RUN, SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { CullParameters, PagePlan } from '../../data/layout/structs.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { compactChunks, planCull as planReference, prefixScan } from './cull.reference.ts';
import { planCull } from './cull.ts';

const gpu = testGpu();

const isFull = process.env.WEBSPLATTER_FULL === '1';

const GARBAGE = 0xdeadbeef;

interface Frame {
  readonly pageCount: number;
  /** Share of the chunks that is visible. */
  readonly visiblePart: number;
  readonly dispatchRow: number;
  /** Chunks of each page; default: up to 40. */
  readonly chunkCounts?: readonly number[];
  readonly isNarrow?: boolean;
}

/** Contents of the buffers after the stage, and the contents that the reference expects. */
async function run(frame: Frame, pipelines = gpu.pipelines) {
  const { pageCount, visiblePart, dispatchRow, isNarrow = false } = frame;
  const random = seededRandom(pageCount + visiblePart);
  const { chunkCounts = Array.from({ length: pageCount }, () => 1 + Math.floor(40 * random())) } = frame;
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
    // A word more than there are sums, and the words of chunks that are not visible, must not change.
    chunkOffsets: gpu.storage([...flags, GARBAGE, GARBAGE]),
    visibleChunks: garbage(chunkCount + 1),
  };
  const bindings = { cullParameters: gpu.uniform(parameters), ...written };
  await gpu.run(planCull(isNarrow), bindings, [1, 1, 1], pipelines);
  const { slots, slotCount, workgroups } = planReference(flags, pages);
  const actual: Record<string, Uint32Array> = {};
  for (const [name, buffer] of Object.entries(written)) actual[name] = await gpu.read(buffer);
  const visibleChunks = new Uint32Array(chunkCount + 1).fill(GARBAGE);
  visibleChunks.set(compactChunks(flags));
  const expected = {
    pagePlans: plansOf(slots),
    slotCount: Uint32Array.of(slotCount),
    cullDispatches: Uint32Array.from(workgroups.flatMap((count) => dispatchSize(count, dispatchRow))),
    depthRange: new Uint32Array(2),
    chunkOffsets: Uint32Array.from([...prefixScan(flags), GARBAGE]),
    visibleChunks,
  };
  return { actual, expected };
}

const { SCAN_WORKGROUP } = SHADER_CONSTANTS;

/** Values of `visiblePart` and `dispatchRow`. */
const FRAMES = isFull
  ? [0, 0.3, 1].flatMap((part) => [7, 65_535].map((row) => [part, row] as const))
  : ([
      [0, 7],
      [0.3, 65_535],
      [1, 7],
    ] as const);

describe('plan-cull', () => {
  for (const isNarrow of [false, true]) {
    const by = isNarrow ? 'one thread' : 'threads together';
    for (const pageCount of [1, 2, SCAN_WORKGROUP, SCAN_WORKGROUP + 1, 2 * SCAN_WORKGROUP + 5]) {
      const name = `${pageCount} pages by ${by}: the reference's chunks, slots and dispatches`;
      gpuTest(name, { tags: 'deeper' }, async () => {
        for (const [visiblePart, dispatchRow] of FRAMES) {
          const { actual, expected } = await run({ pageCount, visiblePart, dispatchRow, isNarrow });
          expect(actual, `${visiblePart} visible, rows of ${dispatchRow}`).toEqual(expected);
        }
      });
    }

    gpuTest(`any number of chunks by ${by}`, async () => {
      for (const chunkCount of [1, 7, 8, 255, 256, 257, SCAN_RUN - 1, SCAN_RUN, SCAN_RUN + 1, 100_003]) {
        const frame = { pageCount: 2, chunkCounts: [chunkCount, 3], dispatchRow: 7, isNarrow };
        const { actual, expected } = await run({ ...frame, visiblePart: 0.7 });
        expect(actual, `${chunkCount} chunks`).toEqual(expected);
      }
    });
  }

  for (const [flaw, find, replace] of [
    ['a thread that plans only its first page', 'page += SCAN_WORKGROUP', 'page += 1000u'],
    ['a run that forgets the runs before', 'slots += sums.total', 'slots = sums.total'],
  ]) {
    gpuTest(`${flaw} is noticed`, async () => {
      const mutation = { file: 'stages/plan-cull', find, replace };
      const frame = { pageCount: SCAN_WORKGROUP + 1, visiblePart: 1, dispatchRow: 7 };
      const { actual, expected } = await run(frame, new Pipelines(gpu.device, mutation));
      expect(actual).not.toEqual(expected);
    });
  }
});
