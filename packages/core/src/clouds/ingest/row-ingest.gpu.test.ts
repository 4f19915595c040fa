// Proves: the GPU makes of any PLY the same splats and errors as the CPU.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import fc from 'fast-check';
import { beforeAll, describe, expect } from 'vitest';
import { createEngine, type SplatEngine } from '../../create-engine.ts';
import { GpuLimitError, SplatFileError } from '../../data/errors.ts';
import { packSet } from '../../data/packing/pack-set.ts';
import { coefficientsPerSplat, type SplatSet } from '../../data/splats/splat-set.ts';
import { encodePly } from '../../io/formats/ply/write-ply.ts';
import { writeSplats } from '../../io/formats/writers.ts';
import { readSplats } from '../../io/loading/read-splats.ts';
import { deviceWith } from '../../testing/device-with.ts';
import {
  expectSameChunks,
  expectSameGeometry,
  expectSameHarmonics,
} from '../../testing/expect-same-planes.ts';
import { Choices } from '../../testing/fuzz.ts';
import { glbBytes, gltfOf, splatAttributes } from '../../testing/gltf-fixture.ts';
import { ownHarmonics } from '../../testing/own-harmonics.ts';
import { planeWords } from '../../testing/plane-words.ts';
import { type Fixture, plyBytes, splatNames } from '../../testing/ply-fixture.ts';
import { randomSplats, splatsWithTies } from '../../testing/random-splats.ts';
import { readableDevice } from '../../testing/readable-device.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { signalOf } from '../../testing/signal.ts';
import { sogExample, sogFiles } from '../../testing/sog-fixture.ts';
import { zipBytes } from '../../testing/zip-fixture.ts';

const PACKED = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
const FINEST = { geometryPrecision: 'f32', shPrecision: 'f32' } as const;
const isFull = process.env.WEBSPLATTER_FULL === '1';
/** Every degree with both precisions. In the first tier, `ingest-rows` shows what is left out. */
const DEGREES = ([0, 1, 2, 3] as const)
  .flatMap((shDegree) => [PACKED, FINEST].map((precision) => [shDegree, precision] as const))
  .filter(([shDegree, precision]) => isFull || (shDegree % 2 === 0) === (precision === PACKED));

let device: GPUDevice;
/** Two chunks per page, and pieces of one chunk. */
let small: SplatEngine;
let large: SplatEngine;
beforeAll(async () => {
  device = await shareTestDevice();
  const bytes = 180 * 512;
  const limited = readableDevice(device, { maxStorageBufferBindingSize: bytes });
  small = await createEngine({ device: limited }, { ingestMinRows: 1, maxWorkgroupsPerDimension: 2 });
  large = await createEngine({ device: readableDevice(device) }, { ingestMinRows: 1 });
});

/** Loads `file` on the GPU and on the CPU, and expects the same cloud. */
async function expectSame(
  file: Blob,
  precision: typeof PACKED | typeof FINEST,
  engine: SplatEngine,
): Promise<void> {
  await engine.setAccuracy({ ...precision });
  const { cloudsDestroyed } = engine.counters();
  const before = engine.memory().totalBytes;
  const cloud = await engine.load(file, { name: 'rows' });
  expect(engine.memory().totalBytes, 'only the planes are left').toBe(before + cloud.bytes);
  const expected = packSet(await readSplats(file, { shPrecision: precision.shPrecision }), precision);
  expect(cloud.count).toBe(expected.count);
  expect(cloud.fileIndices).toEqual(expected.fileIndices);
  expect(cloud.dropped).toEqual(expected.dropped);
  expect(cloud.origin).toEqual(expected.origin);
  expect(cloud.bounds).toEqual(expected.bounds);
  expect(cloud.robustBounds).toEqual(expected.robustBounds);
  const { shBandReach, ...facts } = expected.facts;
  expect(cloud.facts).toMatchObject(facts);
  // Coefficients beyond 1e18 count as 1e18, and those below 1e-19 as 0.
  for (const [i, reach] of shBandReach.entries())
    expect(Math.abs(Math.min(cloud.facts.shBandReach[i], 1e17) - Math.min(reach, 1e17))).toBeLessThanOrEqual(
      1e-6 * reach + 1e-18,
    );
  expectSameChunks(new Float32Array(cloud.chunks), new Float32Array(expected.chunks));
  const [page] = cloud.pagesFor(precision).pages;
  expect(page.splatCount).toBeLessThanOrEqual(cloud.count);
  const { geometry } = expected;
  const harmonics = ownHarmonics(expected.harmonics);
  const geometryPlane = cloud.planes.geometryPlane(precision.geometryPrecision)!;
  const geometryWords = await planeWords(cloud, geometryPlane, geometry.words.length / cloud.count);
  const chunks = new Float32Array(cloud.chunks);
  expectSameGeometry({ ...geometry, words: geometryWords, chunks }, geometry);
  const shPlane = cloud.planes.shPlane(precision.shPrecision)!;
  const shWords = await planeWords(cloud, shPlane, harmonics.wordsPerSplat);
  expectSameHarmonics({ ...harmonics, words: shWords }, harmonics, cloud.count);
  cloud.destroy();
  expect(engine.memory().totalBytes).toBe(before);
  expect(engine.counters().cloudsDestroyed).toBe(cloudsDestroyed + 1);
}

const plyOf = (set: SplatSet) => new Blob([encodePly(set)]);

/** 700 splats of random values by these names. */
function randomPly(names: readonly string[], format: Fixture['format']): Blob {
  const count = 700;
  const random = seededRandom(names.length);
  const properties = names.map((name) => ({
    name,
    type: 'float',
    values: Array.from({ length: count }, () => Math.fround(random() - 0.5)),
  }));
  return new Blob([plyBytes({ format, elements: [{ name: 'vertex', count, properties }] })]);
}

describe('a file whose rows are taken by the GPU becomes the cloud that the CPU makes', () => {
  for (const [shDegree, precision] of DEGREES) {
    const name = `degree ${shDegree}, ${precision.geometryPrecision}, several pages`;
    gpuTest(name, { tags: 'deeper' }, async () => {
      await expectSame(plyOf(splatsWithTies(1300, shDegree)), precision, small);
    });
  }

  for (const count of [1, 2, 255, 256, 257, 3000]) {
    gpuTest(`${count} splats`, () => expectSame(plyOf(splatsWithTies(count, 1)), PACKED, large));
  }

  for (const [what, droppedEvery] of [
    ['few', 97],
    ['half of the', 2],
  ] as const) {
    for (const engine of [() => small, () => large]) {
      /**
       * @fault GPU memory: many rows of a large file are not finite
       * @consequence the file fits if a file without these rows does
       */
      gpuTest(`without ${what} rows, which are not finite`, async () => {
        await expectSame(plyOf(splatsWithTies(1400, 2, droppedEvery)), PACKED, engine());
      });
    }
  }

  for (const trueDegree of [0, 1, 2] as const) {
    gpuTest(`of degree 3, with nothing above degree ${trueDegree}`, { tags: 'deeper' }, async () => {
      const set = splatsWithTies(900, 3);
      for (let i = 0; i < set.count; i++)
        set.harmonics.coefficients.fill(0, 45 * i + coefficientsPerSplat(trueDegree), 45 * (i + 1));
      for (const [degree, precision] of DEGREES)
        if (degree === trueDegree) await expectSame(plyOf(set), precision, small);
    });
  }

  // In the short run, degrees 1 and 2 are shown with harmonics of each splat's own.
  for (const shDegree of isFull ? ([1, 2, 3] as const) : ([3] as const)) {
    gpuTest(`of degree ${shDegree}, with harmonics that splats share`, { tags: 'deeper' }, async () => {
      // The palette comes in several pieces.
      const sog = sogExample({ version: 2, count: 600, shDegree, paletteSize: 400 }, new Choices(shDegree));
      const file = new Blob([zipBytes(sogFiles(sog))]);
      if (isFull) await expectSame(file, PACKED, small);
      await expectSame(file, FINEST, small);
    });
  }

  for (const shDegree of isFull ? ([1, 2, 3] as const) : ([3] as const)) {
    gpuTest(
      `of degree ${shDegree}, with harmonics that are bytes of the file`,
      { tags: 'deeper' },
      async () => {
        for (const [format, origin, precisions] of [
          ['compressed-ply', [0, 0, 0], []],
          ['compressed-ply', [500_000.25, 5_300_000.5, 700], [PACKED]],
          ['spz', [0, 0, 0], [FINEST]],
        ] as const) {
          const set = randomSplats({ count: isFull ? 1300 : 600, shDegree, origin });
          const file = new Blob([await writeSplats(set, format)]);
          for (const precision of isFull ? [PACKED, FINEST] : precisions)
            await expectSame(file, precision, precision === PACKED ? small : large);
        }
      },
    );
  }

  for (const format of ['binary_little_endian', 'binary_big_endian'] as const) {
    gpuTest(`of degree 4, without that band, ${format}`, async () => {
      const names = [...splatNames(0), ...Array.from({ length: 72 }, (_, i) => `f_rest_${i}`)];
      const file = randomPly(names, format);
      await expectSame(file, PACKED, small);
      await expectSame(file, FINEST, large);
    });
  }

  gpuTest('with the 3D filter of Mip-Splatting, which is fused', async () => {
    const file = randomPly([...splatNames(1), 'filter_3D'], 'binary_little_endian');
    await expectSame(file, PACKED, small);
    await expectSame(file, FINEST, large);
  });

  gpuTest('of few splats, whose harmonics are halfway between steps of a byte', async () => {
    const set = randomSplats({ count: 5, seed: 1, shDegree: 2 });
    const { coefficients } = set.harmonics;
    // The first is the largest of its splat, which decides the steps.
    for (let i = 0; i < coefficients.length; i++) coefficients[i] = i % 24 === 0 ? 1 : (i + 0.5) / 127;
    await expectSame(plyOf(set), PACKED, small);
  });

  /** @fault Files: log scales of −∞ in a PLY, or in the bounds of a compressed one */
  gpuTest('of splats that are flat, by log scales of −∞, or have infinite logits', async () => {
    const set = splatsWithTies(900, 1);
    for (let i = 0; i < set.count; i += 3) set.logScales[3 * i + (i % 9) / 3] = Number.NEGATIVE_INFINITY;
    set.logScales.fill(Number.NEGATIVE_INFINITY, 0, 3 * 300);
    for (let i = 0; i < set.count; i += 7) set.opacityLogits[i] = i % 2 === 0 ? Infinity : -Infinity;
    await expectSame(plyOf(set), PACKED, small);
    await expectSame(plyOf(set), FINEST, large);
  });

  gpuTest('far from its origin', async () => {
    const set = splatsWithTies(700, 0);
    for (let i = 0; i < set.positions.length; i++) set.positions[i] += [5000, 0, -70_000][i % 3];
    await expectSame(plyOf(set), PACKED, small);
    await expectSame(plyOf(set), FINEST, small);
  });

  /** @fault Files: single failed or stray points lie far from the scene: at 0, at 1e7, on either side */
  const farName = 'far from its origin, with single splats elsewhere and rows that are dropped';
  gpuTest(farName, { tags: 'deeper' }, async () => {
    // More rows than are sampled for the origin.
    const set = splatsWithTies(9000, 0, 97);
    for (let i = 0; i < set.positions.length; i++) set.positions[i] += [5000, 0, -70_000][i % 3];
    for (let i = 0; i < set.count; i += 300) set.positions.fill(i % 600 === 0 ? 0.1 : 1e7, 3 * i, 3 * i + 3);
    const { origin } = await readSplats(plyOf(set));
    expect(Math.abs(origin[2] + 70_000)).toBeLessThan(1);
    if (isFull) await expectSame(plyOf(set), PACKED, small);
    await expectSame(plyOf(set), FINEST, large);
  });

  /**
   * @fault Files: parts of a scene, of a glTF or of scenes that `convert --merge` joins lie too far apart
   *   for float32 about any one origin
   */
  gpuTest('of two clusters, so far apart that a note tells so', async () => {
    const set = randomSplats({ count: 300, shDegree: 0, logScales: [-4, -4] });
    const { json, binary } = gltfOf(splatAttributes(set));
    json.nodes = [0, 1e7].map((x) => ({ mesh: 0, translation: [x, 0, 0] }));
    json.scenes = [{ nodes: [0, 1] }];
    const file = new Blob([glbBytes({ json, binary })]);
    const { fileFacts } = await readSplats(file);
    expect(fileFacts?.notes).toEqual([expect.stringContaining('too far apart for float32')]);
    for (const precision of [PACKED, FINEST]) await expectSame(file, precision, large);
  });

  gpuTest('far from its origin, in finer steps than those of float32', async () => {
    const set = randomSplats({ count: 600, shDegree: 0, origin: [500_000.25, 5_300_000.5, 700] });
    for (const format of ['sog', 'compressed-ply']) {
      const file = new Blob([await writeSplats(set, format)]);
      const { origin } = await readSplats(file);
      expect(Math.abs(origin[1] - set.origin[1])).toBeLessThan(1);
      await expectSame(file, PACKED, small);
      await expectSame(file, FINEST, large);
    }
  });

  gpuTest('of any positions', { tags: 'deeper' }, async () => {
    const coordinate = fc.float({ noNaN: false, noDefaultInfinity: false });
    await fc.assert(
      fc.asyncProperty(fc.array(coordinate, { minLength: 3, maxLength: 60 }), async (values) => {
        const count = Math.floor(values.length / 3);
        const set = randomSplats({ count, seed: 1, shDegree: 0 });
        set.positions.set(values.slice(0, 3 * count));
        // Not all of them may be dropped.
        set.positions.fill(0.5, 0, 3);
        await expectSame(plyOf(set), PACKED, large);
      }),
      { numRuns: isFull ? 30 : 5 },
    );
  });
});

/** A device that compiles shaders only after `go`. */
function withLateShaders(whole: GPUDevice, go: Promise<void>): GPUDevice {
  return deviceWith(whole, {
    createComputePipelineAsync: (descriptor: GPUComputePipelineDescriptor) =>
      go.then(() => whole.createComputePipelineAsync(descriptor)),
  });
}

gpuTest('rows are read while shaders compile, up to sixteen pieces, and the cloud is the same', async () => {
  const { when: go, give: compile } = signalOf();
  const limited = readableDevice(device, { maxStorageBufferBindingSize: 180 * 512 });
  const late = await createEngine({ device: withLateShaders(limited, go) }, { ingestMinRows: 1 });
  const pieces = () => late.memory().resources.filter(({ label }) => label.startsWith('ingest staging'));
  // Twenty pieces of one chunk.
  const same = expectSame(plyOf(splatsWithTies(20 * 256, 1)), PACKED, late);
  await expect.poll(() => pieces().length).toBe(16);
  compile();
  await same;
  late.destroy();
});

gpuTest('memory that is lacking for pieces that wait fails the load, and leaves nothing', async () => {
  const { when: go, give: compile } = signalOf();
  let pieces = 0;
  const limits = { maxStorageBufferBindingSize: 180 * 512 };
  const counted = readableDevice(device, limits, (label) => {
    if (label.startsWith('ingest staging')) pieces++;
    if (pieces === 7) compile();
  });
  const lacking = deviceWith(counted, {
    popErrorScope: async () =>
      (await counted.popErrorScope()) ?? (pieces >= 6 ? { message: 'out of memory' } : null),
  });
  const late = await createEngine({ device: withLateShaders(lacking, go) }, { ingestMinRows: 1 });
  const before = late.memory().totalBytes;
  await expect(late.load(plyOf(splatsWithTies(20 * 256, 1)), { name: 'many' })).rejects.toThrow(
    GpuLimitError,
  );
  expect(late.memory().totalBytes).toBe(before);
  late.destroy();
});

const RUNS = isFull ? 300 : 20;

/** Any value that rows may hold, in its bits. */
const anyFloat = fc.oneof(
  { weight: 8, arbitrary: fc.float({ min: -4, max: 4, noNaN: true }) },
  { weight: 1, arbitrary: fc.float() },
);

/** Any PLY of splats: properties in any order, others between, elements before, few splats. */
const anyPly = fc
  .record({
    count: fc.integer({ min: 1, max: 5 }),
    degree: fc.constantFrom(0 as const, 1 as const, 2 as const),
    format: fc.constantFrom('binary_little_endian' as const, 'binary_big_endian' as const),
    others: fc.array(fc.constantFrom('uchar', 'short', 'int', 'double', 'float'), { maxLength: 3 }),
    hasMeta: fc.boolean(),
    hasFilter: fc.boolean(),
    seed: fc.integer(),
  })
  .chain(({ count, degree, others, hasFilter, ...rest }) => {
    const filter = hasFilter ? ['filter_3D'] : [];
    const names = [...splatNames(degree), ...filter, ...others.map((_, i) => `other_${i}`)];
    return fc.record({
      ...Object.fromEntries(Object.entries(rest).map(([name, value]) => [name, fc.constant(value)])),
      order: fc.shuffledSubarray(names, { minLength: names.length }),
      types: fc.constant(Object.fromEntries(others.map((type, i) => [`other_${i}`, type]))),
      values: fc.array(anyFloat, { minLength: count * names.length, maxLength: count * names.length }),
      count: fc.constant(count),
    }) as unknown as fc.Arbitrary<AnyPly>;
  });

interface AnyPly {
  readonly count: number;
  readonly format: Fixture['format'];
  readonly hasMeta: boolean;
  readonly order: readonly string[];
  /** Of the properties that are not float. */
  readonly types: Readonly<Record<string, string>>;
  readonly values: readonly number[];
}

function fileOf({ count, format, hasMeta, order, types, values }: AnyPly): Blob {
  const properties = order.map((name, i) => ({
    name,
    type: types[name] ?? 'float',
    values: Array.from({ length: count }, (_, row) => values[row * order.length + i]),
  }));
  const meta = { name: 'meta', count: 3, properties: [{ name: 'a', type: 'short', values: [1, 2, 3] }] };
  const vertex = { name: 'vertex', count, properties };
  return new Blob([plyBytes({ format, elements: hasMeta ? [meta, vertex] : [vertex] })]);
}

gpuTest(
  `${RUNS} files of any layout and any values: the same splats, or the same error`,
  { tags: 'deeper' },
  async () => {
    await fc.assert(
      fc.asyncProperty(anyPly, async (ply) => {
        const file = fileOf(ply);
        const onCpu = await readSplats(file, { name: 'any.ply' }).catch((error: Error) => error);
        if (!(onCpu instanceof Error)) return expectSame(file, PACKED, large);
        await expect(large.load(file, { name: 'any.ply' })).rejects.toThrow(onCpu.message);
      }),
      { numRuns: RUNS },
    );
  },
);

gpuTest('a file of which many rows are dropped needs no more memory than one of as many splats', async () => {
  // Pieces so small that they take less than planes do.
  const limited = readableDevice(device, { maxStorageBufferBindingSize: 64 * 512 });
  const options = { device: limited, accuracy: { geometryPrecision: 'f32' } } as const;
  const seams = { ingestMinRows: 1 };
  const set = randomSplats({ count: 8000, seed: 1, shDegree: 0 });
  const whole = await createEngine(options, seams);
  const { bytes } = await whole.load(plyOf(set));
  const memoryBudgetBytes = whole.memory().peakBytes;
  for (let row = 0; row < set.count; row += 10) set.positions[3 * row] = Number.NaN;
  // Slots of dropped rows are given back where planes without them fit beside those with them.
  const narrow = await createEngine({ ...options, memoryBudgetBytes }, seams);
  const roomy = await narrow.load(plyOf(set));
  expect(roomy.count).toBe(7200);
  expect(roomy.bytes).toBeGreaterThan(0.95 * bytes);
  expect((await whole.load(plyOf(set))).bytes).toBeLessThan(0.95 * bytes);
  for (const engine of [whole, narrow]) engine.destroy();
});

describe('a file that fails leaves nothing', () => {
  gpuTest('without a row that can be drawn', async () => {
    const set = randomSplats({ count: 300, seed: 1, shDegree: 1 });
    set.rotations.fill(Number.NaN);
    const before = large.memory().totalBytes;
    const load = large.load(plyOf(set), { name: 'broken.ply' });
    await expect(load).rejects.toThrow(SplatFileError);
    await expect(load).rejects.toThrow(
      /broken\.ply: no splats to show: all were left out: 300 non-finite-rotation/,
    );
    expect(large.memory().totalBytes).toBe(before);
  });

  gpuTest('cut off, or aborted while it is read', async () => {
    const bytes = encodePly(randomSplats({ count: 40_000, seed: 1, shDegree: 3 }));
    const before = large.memory().totalBytes;
    // The server promises more than it sends.
    const reason = new Error('enough');
    const aborted = new AbortController();
    const load = large.load(new Blob([bytes]), {
      signal: aborted.signal,
      onProgress: () => aborted.abort(reason),
    });
    await expect(load).rejects.toBe(reason);
    expect(large.memory().totalBytes).toBe(before);
  });
});
