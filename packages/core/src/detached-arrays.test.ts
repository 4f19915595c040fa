import { expect, test } from 'vitest';
import { SplatSelection } from './data/splats/splat-selection.ts';
import { checkInstances } from './frame/plan/cloud-instances.ts';
import * as core from './index.ts';
import { BrickWriter } from './io/formats/bricks/brick-writer.ts';
import { memoryFile } from './io/formats/bricks/temporary-files.ts';
import * as ownData from './own-data.ts';
import { randomSplats } from './testing/random-splats.ts';
import * as write from './write.ts';

type Typed = Float64Array | Float32Array | Uint32Array | Uint8Array | Uint16Array;

/** A copy whose memory is then given away, as `postMessage` with a transfer list does. */
function detached<Kind extends Typed | ArrayBuffer>(value: Kind): Kind {
  const copy = structuredClone(value);
  structuredClone(copy, { transfer: [copy instanceof ArrayBuffer ? copy : (copy.buffer as ArrayBuffer)] });
  return copy;
}

/** Of ES2024, which the types of this repository are older than. */
type Resizable = ArrayBuffer & { resize(byteLength: number): void };

/** An array of the same kind and length whose memory then became less than it views. */
function shrunk(values: Typed): Typed {
  const { byteLength, length } = values;
  const buffer = Reflect.construct(ArrayBuffer, [byteLength, { maxByteLength: byteLength }]) as Resizable;
  const array = new (values.constructor as Uint8ArrayConstructor)(buffer, 0, length);
  buffer.resize(0);
  return array;
}

/** Arrays without memory, and those of what is no number. */
function wrongArrays(values: Typed): unknown[] {
  const gone = detached(values);
  const view = new DataView(new ArrayBuffer(values.byteLength));
  structuredClone(view, { transfer: [view.buffer] });
  const others = [null, Symbol('a number'), Object.create(null)].map((each) => [...values].with(0, each));
  const whole = new DataView(new ArrayBuffer(values.byteLength));
  return [gone, shrunk(values), view, whole, new BigInt64Array(values.length), ...others, null, [null]];
}

/** `value` with each array in it, one after another, wrong. */
function wrongly(value: unknown): unknown[] {
  if (ArrayBuffer.isView(value)) return wrongArrays(value as Typed);
  if (value instanceof ArrayBuffer) return [detached(value), null];
  if (typeof value !== 'object' || value === null) return [];
  return Object.entries(value).flatMap(([key, member]) =>
    wrongly(member).map((wrong) =>
      Array.isArray(value) ? value.with(Number(key), wrong) : { ...value, [key]: wrong },
    ),
  );
}

const SET = randomSplats({ count: 40, seed: 1, shDegree: 1 });
const PACKED = core.packCloud(SET, { geometryPrecision: 'packed', shPrecision: 'u8' });
const PRECISION = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
const CLOUD = { pool: null, name: 'a cloud', count: 40 } as core.SplatCloud;
const INSTANCES = {
  modelMatrices: new Float64Array(32),
  tints: new Float32Array(6),
  opacities: new Float32Array(2),
};
const VALUES = {
  positions: new Float32Array(3).fill(1),
  scales: new Float32Array(3).fill(1),
  rotations: new Float32Array(4).fill(1),
  opacities: new Float32Array(1),
  colors: new Float32Array(3),
};
const ROWS = new Uint32Array([1, 2]);
const MATRIX = new Float64Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
const PLY = core.encodePly(SET);
const journalOf = (...entries: unknown[]) =>
  ({
    entries: async function* () {
      yield* entries;
    },
    note: async () => {},
  }) as never;
const ARRIVED = { kind: 'arrived', rows: 0, runs: [], bounds: [], told: [], sample: new Float64Array() };
const COLUMN = new Float32Array(1);
const LENGTHS = { sizes: new Float32Array(2), bounds: new Float32Array(6) };
const ROUNDING = { positions: {}, float32Positions: {}, scales: {}, colors: {}, harmonics: {} };
const MADE_OF = { samples: COLUMN, largestScales: COLUMN, errors: COLUMN, rounding: ROUNDING, ...LENGTHS };
const MADE = {
  kind: 'made',
  at: 0,
  byteCount: 4,
  range: null,
  made: { first: 0, fragments: [], ...MADE_OF },
};
const RUN = {
  count: 256,
  words: 14,
  origin: [0, 0, 0],
  harmonics: { degree: 0, precision: 'u8', wordsPerSplat: 0 },
};
/** Splats that came, so many. */
const arrived = (count: number) => ({
  ...ARRIVED,
  runs: [{ run: { ...RUN, count }, at: 0 }],
  bounds: [{ min: [0, 0, 0], max: [1, 1, 1] }],
  sample: new Float64Array(5),
});
const madeWith = (changes: object) => ({ ...MADE, made: { ...MADE.made, ...changes } });

const SKIN = { indices: new Uint8Array(4), weights: new Float32Array([1, 0, 0, 0]) };

const CALLS: readonly [string, (value: never) => unknown, unknown][] = [
  ['instances', (value) => checkInstances(value, CLOUD), INSTANCES],
  ['edited values', (value) => new ownData.SplatEdits(40).set({ first: 0, count: 1 }, value), VALUES],
  ['edited rows', (value) => new ownData.SplatEdits(40).set(value, { visible: false }), ROWS],
  ['restored rows', (value) => new ownData.SplatEdits(40).reset(value), ROWS],
  ['selected rows', (value) => new SplatSelection().add(value), ROWS],
  ['deselected rows', (value) => new SplatSelection().delete(value), ROWS],
  ['toggled rows', (value) => new SplatSelection().toggle(value), ROWS],
  ['arrays', (value) => ownData.splatsFromArrays(value), { ...VALUES, opacities: new Float32Array([0.5]) }],
  [
    'packSet',
    (value) => ownData.packSet(value, { geometryPrecision: 'packed', shPrecision: 'u8' } as never),
    SET,
  ],
  ['packCloud', (value) => core.packCloud(value, PRECISION), SET],
  ['encodePly', (value) => core.encodePly(value), SET],
  ['makeRayTree', (value) => core.makeRayTree(value), PACKED],
  ['SplatMorph', (value) => new ownData.SplatMorph(value, value, PRECISION), SET],
  ['SplatSkin', (value) => new ownData.SplatSkin(value, 3), SKIN],
  ['setPose', (value) => new ownData.SplatSkin(SKIN, 1).setPose(value), MATRIX],
  ['viewMatrix', (value) => core.cameraFromMatrices(value, MATRIX), MATRIX],
  ['projectionMatrix', (value) => core.cameraFromMatrices(MATRIX, value), MATRIX],
  ['selected words', (value) => new SplatSelection().setWords(value), ROWS],
  ['readSplats', (value) => core.readSplats(value), PLY],
  ['readSplats of memory', (value) => core.readSplats(value), PLY.buffer],
  ['loadSplats', (value) => core.loadSplats(value), PLY],
  ['writeSplats', (value) => write.writeSplats(value, 'ply'), SET],
  ['mergeSplats', (value) => write.mergeSplats(value), [SET, SET]],
  [
    'cropSplats',
    (value) => write.cropSplats(value, { center: [0, 0, 0], halfSize: [1, 1, 1] } as never),
    SET,
  ],
  ['filterSplats', (value) => write.filterSplats(value, {} as never), SET],
  ['limitDegree', (value) => write.limitDegree(value, 0), SET],
  ['transformSplats', (value) => write.transformSplats(value, {} as never), SET],
  [
    'BrickWriter.add',
    async (value) => {
      const writer = new BrickWriter();
      await writer.add(value).finally(() => writer.end());
    },
    SET,
  ],
  ['a journal', (value) => new BrickWriter({ journal: journalOf(value) }).resume(), null],
  ['a journal', (value) => new BrickWriter({ journal: journalOf(value) }).resume(), {}],
  [
    'a journal',
    (value) => new BrickWriter({ journal: journalOf(value) }).resume(),
    { ...ARRIVED, runs: null },
  ],
  [
    'a journal',
    (value) => new BrickWriter({ journal: journalOf(value) }).resume(),
    { ...ARRIVED, told: null },
  ],
  ['a journal', (value) => new BrickWriter({ journal: journalOf(value) }).resume(), { kind: 'divided' }],
  ['a journal', (value) => new BrickWriter({ journal: journalOf(value) }).resume(), { kind: 'made' }],
];

/**
 * @fault Arguments: an array or its memory was transferred to another thread or shrunk, has BigInts or
 *   symbols in place of numbers, or is null
 * @consequence `InvalidArgumentError` that names it; nothing changes
 */
test.each(CALLS)(
  '%s without memory, of no numbers, or missing, are taken or refused by name',
  async (name, call, value) => {
    const wrong: unknown[] = [];
    for (const each of name === 'a journal' ? [value] : [null, ...wrongly(value)]) {
      try {
        await call(each as never);
      } catch (error) {
        if (!(error instanceof core.WebSplatterError)) wrong.push((error as Error).stack!);
      }
    }
    expect(wrong).toEqual([]);
  },
);

/**
 * @fault Arguments: a journal has an entry that no writer notes, such as one of no splats
 * @consequence `InvalidArgumentError` that names the member
 */
test.each<[string, unknown]>([
  ['entry.rows', { ...ARRIVED, rows: -1 }],
  ['entry.rows', { ...ARRIVED, rows: Number.NaN }],
  ['entry.sample', { ...ARRIVED, sample: [1] }],
  ['entry.sizes', { kind: 'divided', depth: 0, first: 0, sizes: [1e300] }],
  ['entry.range.count', { ...MADE, range: { first: 0, count: 0 } }],
  ['entry.range.count', { ...MADE, range: { first: 0, count: -1 } }],
  ['entry.at', { ...MADE, at: 0.5 }],
  ['entry.kind', MADE],
  ['entry.made.rounding', madeWith({ rounding: undefined })],
  ['entry.made.bounds.length', madeWith({ bounds: COLUMN })],
])('a journal whose %s is none is refused', async (argument, entry) => {
  const resuming = new BrickWriter({ journal: journalOf(entry) }).resume();
  await expect(resuming).rejects.toMatchObject({ name: 'InvalidArgumentError', argument });
});

test.each<[string, object]>([
  ['entry.made.first', madeWith({ first: 4096 })],
  ['entry.made.first', madeWith({ first: 1 })],
  ['entry.made.fragments', madeWith({ fragments: [{ first: 200, words: new Uint32Array(14 * 57) }] })],
])('a journal whose %s is that of another scene is refused', async (argument, entry) => {
  const resuming = new BrickWriter({ journal: journalOf(arrived(256), entry) }).resume();
  await expect(resuming).rejects.toMatchObject({ name: 'InvalidArgumentError', argument });
});

/**
 * @fault Arguments: a journal of more splats than memory can hold facts about, of bricks before any
 *   splats, or of bricks of another scene
 * @consequence `InvalidArgumentError` that names the member, or the journal
 */
test('a journal of more splats than there is memory for is refused', async () => {
  const storage = { read: async () => new Uint8Array(), write: async () => {}, remove: async () => {} };
  for (const count of [2 ** 44, Number.MAX_SAFE_INTEGER]) {
    const makeFile = async () => storage;
    const writer = new BrickWriter({ makeFile, journal: journalOf(arrived(count)) });
    await writer.resume();
    await expect(writer.finish(async () => {})).rejects.toMatchObject({
      name: 'InvalidArgumentError',
      argument: 'journal',
    });
    const resuming = new BrickWriter({ makeFile, journal: journalOf(arrived(count), MADE) }).resume();
    await expect(resuming).rejects.toMatchObject({ argument: 'journal' });
    await writer.end();
  }
});

test('a temporary file that memory has no room for is refused', async () => {
  await expect(memoryFile(2 ** 52)).rejects.toThrow(core.SplatSourceError);
  const file = await memoryFile();
  await expect(file.write(new Uint8Array(1), 2 ** 52)).rejects.toThrow(core.SplatSourceError);
});

/**
 * @fault Arguments: a `BrickWriter` with no threads, buckets of no splats, a journal without methods, or
 *   storage that makes no file
 * @consequence `InvalidArgumentError` that names it; the writer ends
 */
test.each<[string, object | null]>([
  ['options', null],
  ['threads', { threads: -1 }],
  ['threads', { threads: Number.NaN }],
  ['bucketSplats', { bucketSplats: 0 }],
  ['run', { run: 5 }],
  ['journal.entries', { journal: {} }],
])('%s of a BrickWriter that are none are refused', (argument, options) => {
  const making = () => new BrickWriter(options as never);
  expect(making).toThrow(expect.objectContaining({ name: 'InvalidArgumentError', argument }));
});

test('storage that makes no file is refused, and the writer ends', async () => {
  const writer = new BrickWriter({ makeFile: async () => null as never });
  await expect(writer.add(SET)).rejects.toMatchObject({ name: 'InvalidArgumentError', argument: 'makeFile' });
  await writer.end();
});
