import { gpuTest } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { ChunkLinks, LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { PagePlan } from '../../data/layout/structs.ts';
import { joined, packFlatPage, packFlatView } from '../../testing/flat-view.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { cutSplats as reference } from './cut.reference.ts';
import { cutSplats } from './cut.ts';

const gpu = testGpu();
const { MASK_WORDS } = SHADER_CONSTANTS;
const CHUNKS = 9;
/** Chunks of the frame before those of the page, and visible ones before those of the page. */
const CHUNK_START = 5;
const SLOT_START = 2;

const TITLE = 'cut-splats: a bit for each splat or blob that the cut goes through, and for no other';

/** @param instances how many times the page is drawn; null: once, without instances. */
async function expectBits(instances: number | null): Promise<void> {
  const random = seededRandom(3);
  const below = (end: number) => Math.floor(random() * end);
  const links = Array.from({ length: CHUNKS }, () =>
    Array.from({ length: CHUNK_SPLATS }, () => {
      const [error, parentError] = [below(40), below(4) === 0 ? LEVEL_CONSTANTS.ERROR_BOUNDLESS : below(40)];
      return below(10) === 0 ? 0 : error + parentError * 2 ** 12 + below(256) * 2 ** 24;
    }),
  );
  const cells = Array.from({ length: CHUNKS }, (_, i) => CHUNKS - 1 - i);
  const count = instances ?? 1;
  const thresholds = Array.from({ length: count * CHUNKS }, () => below(40));
  const words = links.flatMap((own, chunk) => [cells[chunk], 0, 0, 0, 0, 0, 0, 0, ...own]);
  expect(words.length).toBe(CHUNKS * ChunkLinks.words);
  const visible = [0, 2, 3, 7, 8, 11, 17, 19].filter((chunk) => chunk < count * CHUNKS);
  const chunkEnd = CHUNK_START + count * CHUNKS;
  const plan = { chunkStart: CHUNK_START, chunkEnd, visibleStart: 0, visibleCount: 0 };
  const pages = Array.from({ length: count }, (_, i) =>
    packFlatPage(CHUNK_START + i * CHUNKS, CHUNKS, [0, 0, 0, 0], undefined, i * CHUNKS),
  );
  const masks = gpu.storage([], 4 * MASK_WORDS * (SLOT_START + visible.length));
  const bindings = {
    view: gpu.uniform(packFlatView({ size: { widthPx: 1, heightPx: 1 }, alphaCutoff: 0, dispatchRow: 2 })),
    [instances === null ? 'page' : 'pages']: gpu.uniform(joined(pages)),
    pagePlans: gpu.storage(
      new Uint32Array(PagePlan.pack({ ...plan, slotStart: SLOT_START, slotCount: visible.length })),
    ),
    visibleChunks: gpu.storage([1, 1, ...visible.map((chunk) => CHUNK_START + chunk)]),
    links: gpu.storage(words),
    thresholds: gpu.storage(thresholds),
    visibilityMasks: masks,
  };
  // A workgroup more than there are visible chunks.
  await gpu.run(cutSplats(instances), bindings, [2, 3, 1]);
  const bits = await gpu.read(masks);
  for (const [i, chunk] of visible.entries()) {
    const place = Math.floor(chunk / CHUNKS);
    const limit = thresholds[place * CHUNKS + cells[chunk % CHUNKS]];
    const expected = reference(links[chunk % CHUNKS], limit);
    const drawn = expected.map((_, lane) => {
      const word = bits[(SLOT_START + i) * MASK_WORDS + Math.floor(lane / 32)];
      return ((word >>> (lane % 32)) & 1) === 1;
    });
    expect(drawn, `chunk ${chunk}`).toEqual(expected);
  }
  expect(bits.subarray(0, SLOT_START * MASK_WORDS)).toEqual(new Uint32Array(SLOT_START * MASK_WORDS));
}

gpuTest(TITLE, () => expectBits(null));
gpuTest(`${TITLE}, in each of several instances`, () => expectBits(3));
