import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { orderedWords } from '../../data/layout/depth-key.ts';
import { Page, PagePlan } from '../../data/layout/structs.ts';
import { WidePlace, writeWidePlace } from '../../data/layout/wide-place.ts';
import type { Mat3, Vec3 } from '../../data/math/mat4.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { joined, packFlatPage, packFlatView } from '../../testing/flat-view.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { wideSortKey } from './wide-keys.reference.ts';
import { wideKeys } from './wide-keys.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';
const gpu = testGpu();
const GROUP = 256;
const DISPATCH_ROW = 3;

/** A row of view space, and a position that it is taken of. */
interface Place {
  readonly linear: Mat3;
  readonly translation: Vec3;
}

const random = seededRandom(54);
const f64 = new Float64Array(1);
const words = new Uint32Array(f64.buffer);

/** A float64 with any bits of its mantissa, and an exponent of two from −`spread` to `spread`. */
function anyFloat64(spread: number): number {
  words[0] = random() * 2 ** 32;
  words[1] = random() * 2 ** 20 + 2 ** 20 * Math.round(1023 + spread * (2 * random() - 1));
  return random() < 0.5 ? f64[0] : -f64[0];
}

const anyFloat32 = (spread: number) => Math.fround(anyFloat64(spread));

/** Numbers whose sums cancel, are ties between two float64, or end by a carry through all bits. */
const HARD = [0, -0, 1, -1, 3, 2 ** -24, 1 + 2 ** -23, 1 - 2 ** -24, 2 ** 30, 2 ** -60, 4095 / 4096];
const HARD64 = [
  ...HARD,
  ...[1 + 2 ** -52, 1 - 2 ** -53, 2 ** -53, -(2 ** -53), 2 ** 53, 2 ** 52 + 1, 1 / 3, -1 / 3, 0.1, 1e-300],
];
const oneOf = (list: readonly number[]) => list[Math.floor(random() * list.length)];

/** Places and positions: of any numbers alike in size, of any size, and of hard ones. */
function placesOf(kind: 'alike' | 'any' | 'hard'): Place {
  const number = () => (kind === 'hard' ? oneOf(HARD64) : anyFloat64(kind === 'alike' ? 2 : 40));
  return {
    linear: Array.from({ length: 9 }, number) as unknown as Mat3,
    translation: [number(), number(), number()],
  };
}

function positionsOf(kind: 'alike' | 'any' | 'hard', count: number): Float32Array {
  const number = () => (kind === 'hard' ? oneOf(HARD) : anyFloat32(kind === 'alike' ? 2 : 40));
  return Float32Array.from({ length: 3 * count }, number);
}

function centerOf({ linear, translation }: Place, positions: Float32Array, i: number): Vec3 {
  const [x, y, z] = positions.subarray(3 * i, 3 * i + 3);
  return [0, 1, 2].map(
    (row) => linear[row] * x + linear[row + 3] * y + linear[row + 6] * z + translation[row],
  ) as unknown as Vec3;
}

/** Runs the stage over all splats of a page, or of a batch with these places. */
async function run(
  places: readonly Place[],
  positions: Float32Array,
  farthestHigh: number,
  options: { readonly sortsByDistance: boolean; readonly isPacked: boolean; readonly isBatch: boolean },
  pipelines = gpu.pipelines,
) {
  const each = positions.length / 3;
  const chunks = Math.ceil(each / CHUNK_SPLATS);
  const count = each * places.length;
  const room = options.isBatch ? places.length + 1 : 1;
  const stage = wideKeys({
    geometryPrecision: options.isPacked ? 'packed' : 'f32',
    sortsByDistance: options.sortsByDistance,
    batchInstances: options.isBatch ? room : null,
  });
  const geometryWords = options.isPacked ? 8 : 16;
  const geometry = new Float32Array(geometryWords * each);
  for (let i = 0; i < each; i++) geometry.set(positions.subarray(3 * i, 3 * i + 3), geometryWords * i);
  const contents = new ArrayBuffer(WidePlace.bytes * room);
  for (const [i, place] of places.entries())
    writeWidePlace(contents, place, farthestHigh, WidePlace.bytes * i);
  const pages = places.map((_, i) => packFlatPage(chunks * i, chunks, [0, 0, 0, 0], each));
  const plan = PagePlan.pack({
    ...{ chunkStart: 0, chunkEnd: chunks * places.length, slotStart: 0, slotCount: 0 },
    ...{ visibleStart: 0, visibleCount: count },
  });
  const keys = gpu.storage([], 4 * count);
  const upperKeys = gpu.storage([], 4 * count);
  const bindings = {
    view: gpu.uniform(
      packFlatView({ size: { widthPx: 1, heightPx: 1 }, alphaCutoff: 0, dispatchRow: DISPATCH_ROW }),
    ),
    [options.isBatch ? 'pages' : 'page']: gpu.uniform(
      options.isBatch ? joined([...pages, new ArrayBuffer(Page.bytes)]) : pages[0],
    ),
    pagePlans: gpu.storage(new Uint32Array(plan)),
    visibleSplats: gpu.storage(
      Array.from({ length: count }, (_, i) => CHUNK_SPLATS * chunks * Math.floor(i / each) + (i % each)),
    ),
    widePlaces: gpu.uniform(contents),
    geometry: gpu.storage(new Uint32Array(geometry.buffer)),
    keys,
    upperKeys,
  };
  await gpu.run(stage, bindings, dispatchSize(Math.ceil(count / GROUP) + 1, DISPATCH_ROW), pipelines);
  return { low: await gpu.read(keys), high: await gpu.read(upperKeys) };
}

/** Runs the stage and the reference. */
async function compare(
  places: readonly Place[],
  positions: Float32Array,
  options: Parameters<typeof run>[3],
  pipelines?: Pipelines,
) {
  const each = positions.length / 3;
  const farthestHigh = orderedWords(Number.MAX_VALUE).high;
  const got = await run(places, positions, farthestHigh, options, pipelines);
  const centers = places.flatMap((place) =>
    Array.from({ length: each }, (_, i) => centerOf(place, positions, i)),
  );
  const expected = centers.map((center) => wideSortKey(center, options.sortsByDistance, farthestHigh));
  const bad = expected.findIndex(({ low, high }, i) => got.low[i] !== low || got.high[i] !== high);
  return { bad, center: centers[bad], got: [got.high[bad], got.low[bad]], expected: expected[bad] };
}

const FINE = { sortsByDistance: false, isPacked: false, isBatch: false };

describe('wide-keys', () => {
  for (const kind of ['alike', 'any', 'hard'] as const) {
    /**
     * @fault Order: depths differ by rounding alone, as in a lattice from its corner
     * @consequence the rounding of float64 decides, in shaders as on the CPU, to the bit
     */
    gpuTest(`${kind} numbers: every bit of float64`, async () => {
      for (let round = 0; round < 12; round++) {
        const places = [placesOf(kind)];
        const positions = positionsOf(kind, 1000);
        for (const sortsByDistance of [false, true]) {
          const found = await compare(places, positions, { ...FINE, sortsByDistance });
          expect(found.bad, JSON.stringify(found)).toBe(-1);
        }
      }
    });
  }

  gpuTest('packed geometry, and instances with a place each', { tags: 'deeper' }, async () => {
    // In the first tier, the test of instances sorted by 64 bits draws those of f32.
    for (const isPacked of isFull ? [false, true] : [true]) {
      const places = Array.from({ length: 5 }, () => placesOf('alike'));
      const options = { sortsByDistance: true, isPacked, isBatch: true };
      const found = await compare(places, positionsOf('alike', 300), options);
      expect(found.bad, JSON.stringify(found)).toBe(-1);
    }
  });

  gpuTest('a depth beyond the farthest counts as the farthest, and does not wrap around', async () => {
    const place = { linear: [0, 0, 0, 0, 0, 0, 0, 0, -1], translation: [0, 0, 0] } as unknown as Place;
    const positions = Float32Array.of(0, 0, 4, 0, 0, 8, 0, 0, 2);
    const { high } = await run([place], positions, orderedWords(4).high, FINE);
    const step = orderedWords(4).high - orderedWords(2).high;
    expect([...high]).toEqual([0, 0, step]);
  });

  /**
   * @fault Order: a compiler fuses or reorders sums
   * @consequence no effect: these depths are computed in integers
   */
  gpuTest('the comparison finds a sum that is rounded otherwise', { tags: 'deeper' }, async () => {
    const faults = [
      ['if (rest == 0x200u) { mantissa.x &= 0xfffffffeu; }', ''],
      ['return vec2u(words.x | u32(lost != 0u), words.y);', 'return words;'],
      ['let isLost = u32((bottom.x | middle) != 0u);', 'let isLost = 0u;'],
      ['u32(lowFirst < first.y) +', ''],
    ];
    for (const [find, replace] of isFull ? faults : faults.slice(0, 1)) {
      const pipelines = new Pipelines(gpu.device, { file: 'lib/float64', find, replace });
      const kinds = ['alike', 'any', 'hard'] as const;
      const found = await Promise.all(
        kinds.map((kind) => compare([placesOf(kind)], positionsOf(kind, 3000), FINE, pipelines)),
      );
      expect(
        found.some(({ bad }) => bad >= 0),
        find,
      ).toBe(true);
    }
  });
});
