import { gzipSync } from 'node:zlib';
import { describe, expect, test } from 'vitest';
import { fromHalfBits } from '../../../data/layout/half.ts';
import { type PackedHarmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { shRestBasis } from '../../../data/splats/spherical-harmonics.ts';
import { SH_REST_COEFFICIENTS, type SplatSet } from '../../../data/splats/splat-set.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { expectSameSplats, rowsOf } from '../../../testing/rows-of.ts';
import { readSplats } from '../../loading/read-splats.ts';
import type { ReadLimits } from '../../sources/splat-source.ts';
import {
  coordinateSystemExtension,
  distinctSplat,
  FLAG_ANTIALIASED,
  littleEndian,
  type SpzFixture,
  type SpzFixtureSplat,
  smallestThree,
  spzBytes,
  spzExtension,
} from './spz-fixture.ts';

const VERSIONS = [1, 2, 3, 4];
const DEGREES = [0, 1, 2, 3, 4];

const read = (bytes: Uint8Array, limits: ReadLimits = {}) =>
  readSplats(bytes, { shPrecision: 'f32', ...limits });

function splatsOf(version: number, degree: number, count: number): SpzFixtureSplat[] {
  return Array.from({ length: count }, (_, row) => distinctSplat(version, degree, row));
}

const fileOf = (version: number, degree: number, more: Partial<SpzFixture> = {}) =>
  spzBytes({ version, degree, splats: splatsOf(version, degree, 3), ...more });

function harmonicsOf({ harmonics }: SplatSet<PackedHarmonics>, index: number): Float64Array {
  const values = new Float64Array(3 * SH_REST_COEFFICIENTS[harmonics.degree]);
  readCoefficients(harmonics, index, values);
  return values;
}

describe('reads', () => {
  for (const version of VERSIONS)
    test.each(DEGREES)(`version ${version}, harmonics of degree %i`, async (degree) => {
      const splats = splatsOf(version, degree, 5);
      const bytes = spzBytes({ version, degree, splats, fractionalBits: 10 });
      const set = await read(version < 4 ? gzipSync(bytes) : bytes);
      expect(set).toMatchObject({ count: 5, isAntialiased: false, dropped: {} });
      // Degree 4 is left out.
      expect(set.harmonics.degree).toBe(Math.min(degree, 3));
      expect(set.fileFacts).toMatchObject({ format: 'spz', variant: String(version) });
      expect(set.fileFacts?.notes).toEqual(degree > 3 ? [expect.stringContaining('left out')] : undefined);
      const f32 = (values: readonly number[]) => values.map(Math.fround);
      for (const [row, { position, alpha, color, scale, harmonics }] of splats.entries()) {
        const at = position.map((value) => (version === 1 ? fromHalfBits(value) : value / 1024));
        const found = [0, 1, 2].map((axis) => set.positions[3 * row + axis] + set.origin[axis]);
        expect(found).toEqual(at);
        expect([...set.logScales.subarray(3 * row, 3 * row + 3)]).toEqual(
          scale.map((byte) => byte / 16 - 10),
        );
        const opacity = 1 / (1 + Math.exp(-set.opacityLogits[row]));
        expect(opacity).toBeCloseTo(alpha / 255, 6);
        const dc = color.map((byte) => (byte / 255 - 0.5) / 0.15);
        expect([...set.colorDc.subarray(3 * row, 3 * row + 3)]).toEqual(f32(dc));
        const kept = harmonics.slice(0, 45).map((byte) => (byte - 128) / 128);
        expect([...harmonicsOf(set, row)]).toEqual(kept);
      }
    });

  for (const version of VERSIONS)
    test.each(DEGREES)(`version ${version}, harmonics of degree %i, for the GPU as bytes`, async (degree) => {
      const splats = splatsOf(version, degree, 300).map((splat, row) => ({
        ...splat,
        harmonics: splat.harmonics.map(() => row & 255),
      }));
      const bytes = spzBytes({ version, degree, splats });
      const rows = await rowsOf(bytes);
      expect(rows.layout.strideBytes).toBe(56 + [0, 9, 24, 45, 72][degree]);
      expectSameSplats(rows, await read(bytes));
    });

  test('turned harmonics for the GPU', async () => {
    const bytes = fileOf(4, 3, { extensions: coordinateSystemExtension(4) });
    const rows = await rowsOf(bytes);
    expect(rows.layout.byteHarmonics).toBeUndefined();
    expectSameSplats(rows, await read(bytes));
  });

  test('rotations of a byte each: w is the rest', async () => {
    for (const version of [1, 2]) {
      const splats = [
        { ...distinctSplat(version, 0, 0), rotation: [255, 0, 128] },
        { ...distinctSplat(version, 0, 1), rotation: [140, 100, 128] },
      ];
      const { rotations } = await read(spzBytes({ version, degree: 0, splats }));
      // The first one is longer than 1 already.
      expect([...rotations.subarray(0, 4)]).toEqual([0, 1, -1, Math.fround(128 / 127.5 - 1)]);
      const [x, y, z] = [140, 100, 128].map((byte) => byte / 127.5 - 1);
      const w = Math.sqrt(1 - x * x - y * y - z * z);
      expect([...rotations.subarray(4)]).toEqual([w, x, y, z].map(Math.fround));
    }
  });

  test('rotations without their largest component', async () => {
    const others = [
      { isNegative: false, magnitude: 511 },
      { isNegative: true, magnitude: 100 },
      { isNegative: true, magnitude: 7 },
    ];
    const values = others.map(
      ({ isNegative, magnitude }) => ((isNegative ? -1 : 1) * magnitude * Math.SQRT1_2) / 511,
    );
    const rest = Math.sqrt(1 - values.reduce((sum, value) => sum + value * value, 0));
    for (const version of [3, 4]) {
      const splats = [0, 1, 2, 3].map((largest) => ({
        ...distinctSplat(version, 0, largest),
        rotation: smallestThree(largest, others),
      }));
      const { rotations } = await read(spzBytes({ version, degree: 0, splats }));
      for (let largest = 0; largest < 4; largest++) {
        const [x, y, z, w] = values.toSpliced(largest, 0, rest);
        const found = [...rotations.subarray(4 * largest, 4 * largest + 4)];
        for (const [i, value] of [w, x, y, z].entries()) expect(found[i]).toBeCloseTo(value, 6);
      }
    }
  });

  test('rotations that are too long stay finite', async () => {
    const most = { isNegative: true, magnitude: 511 };
    const splat = { ...distinctSplat(4, 0, 0), rotation: smallestThree(3, [most, most, most]) };
    const { rotations } = await read(spzBytes({ version: 4, degree: 0, splats: [splat] }));
    expect([...rotations]).toEqual([0, ...Array(3).fill(Math.fround(-Math.SQRT1_2))]);
  });

  test('opacities of 0 and 1', async () => {
    const splats = [0, 255, 51].map((alpha, row) => ({ ...distinctSplat(3, 0, row), alpha }));
    const { opacityLogits, count } = await read(spzBytes({ version: 3, degree: 0, splats }));
    expect(count).toBe(3);
    const [none, all, fifth] = opacityLogits;
    expect([none, all]).toEqual([Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY]);
    expect(fifth).toBeCloseTo(Math.log(0.25), 6);
  });

  test('whether it was trained with an antialias filter', async () => {
    for (const version of VERSIONS)
      expect((await read(fileOf(version, 1, { flags: FLAG_ANTIALIASED }))).isAntialiased).toBe(true);
  });

  test('halves that are not finite are left out', async () => {
    const splats = [0x7c00, 0xfc00, 0x7e00, 0x3c00].map((half, row) => ({
      ...distinctSplat(1, 0, row),
      position: [0, half, 0],
    }));
    const set = await read(spzBytes({ version: 1, degree: 0, splats }));
    expect(set).toMatchObject({ count: 1, dropped: { 'non-finite-position': 3 } });
    expect([...set.fileIndices]).toEqual([3]);
  });

  test('from version 4 on, also files that gzip has packed once more, and room before the table', async () => {
    const room = spzExtension(0x1234, [1, 2, 3]);
    const bytes = fileOf(4, 2, { extensions: [...room, 9, 9] });
    const plain = await read(fileOf(4, 2));
    expect(await read(bytes)).toEqual(plain);
    expect(await read(gzipSync(bytes))).toEqual(plain);
  });
});

describe('coordinate systems', () => {
  const NAMES = [
    ...['LDB', 'RDB', 'LUB', 'RUB', 'LDF', 'RDF', 'LUF', 'RUF'],
    // Four of these have each other's names in the library that writes them; see `turnToPlyAxes`.
    ...['LBU', 'RBU', 'LFU', 'RFU', 'LBD', 'RBD', 'LFD', 'RFD'],
  ];
  /** Where each letter points to along the axes of PLY files: right, down, front. */
  const DIRECTIONS: Readonly<Record<string, readonly number[]>> = {
    ...{ R: [1, 0, 0], L: [-1, 0, 0], D: [0, 1, 0], U: [0, -1, 0], F: [0, 0, 1], B: [0, 0, -1] },
  };
  const splats = splatsOf(4, 3, 6).map((splat, row) => ({
    ...splat,
    scale: [60, 90, 120],
    rotation: smallestThree(row % 4, [
      { isNegative: row % 2 === 0, magnitude: 150 },
      { isNegative: false, magnitude: 40 * row },
      { isNegative: true, magnitude: 90 },
    ]),
  }));
  const plain = spzBytes({ version: 4, degree: 3, splats });
  type Vector = readonly number[];
  const dot = (a: Vector, b: Vector) => a.reduce((sum, value, i) => sum + value * b[i], 0);

  /** Extent of a splat along a direction, squared. */
  function extent({ logScales, rotations }: SplatSet<PackedHarmonics>, index: number, along: Vector): number {
    const [w, x, y, z] = rotations.subarray(4 * index, 4 * index + 4);
    const axes = [
      [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
      [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
      [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ];
    const norm = (w * w + x * x + y * y + z * z) ** 2;
    return axes.reduce(
      (sum, axis, i) => sum + (dot(axis, along) * Math.exp(logScales[3 * index + i])) ** 2 / norm,
      0,
    );
  }

  const green = (set: SplatSet<PackedHarmonics>, index: number, [x, y, z]: Vector) => {
    const values = harmonicsOf(set, index);
    return dot(
      shRestBasis(3, x, y, z),
      Array.from({ length: 15 }, (_, k) => values[3 * k + 1]),
    );
  };

  test.each(NAMES.map((name, i) => ({ name, system: i + 1 })))('$name', async ({ name, system }) => {
    const file = await read(plain);
    // Where the extensions stand depends on the version; one of the two is enough for most systems.
    for (const version of system < 3 ? [3, 4] : [4]) {
      const extensions = [
        ...spzExtension(0xadbe0002, Array(12).fill(0)),
        ...coordinateSystemExtension(system),
      ];
      const set = await read(spzBytes({ version, degree: 3, splats, extensions }));
      // A vector of the file's axes, in those of PLY files.
      const turned = (vector: Vector) =>
        [0, 1, 2].map((axis) =>
          dot(
            vector,
            [...name].map((letter) => DIRECTIONS[letter][axis]),
          ),
        );
      for (let index = 0; index < splats.length; index++) {
        const at = (from: SplatSet<PackedHarmonics>) =>
          [0, 1, 2].map((axis) => from.positions[3 * index + axis] + from.origin[axis]);
        expect(at(set)).toEqual(turned(at(file)).map((value) => value + 0));
        for (const direction of [
          [0.6, 0.64, 0.48],
          [-0.36, 0.48, 0.8],
          [0.48, -0.8, 0.36],
        ]) {
          const before = extent(file, index, direction);
          expect(extent(set, index, turned(direction)) / before).toBeCloseTo(1, 5);
          // Coefficients are float32: their sum has 45 terms below 1.
          expect(green(set, index, turned(direction))).toBeCloseTo(green(file, index, direction), 5);
        }
      }
    }
  });

  test('splats of a file that names none, or an unspecified one, stay as they are', async () => {
    const file = await read(plain);
    const extensions = coordinateSystemExtension(0);
    expect(await read(spzBytes({ version: 4, degree: 3, splats, extensions }))).toEqual(file);
    // The axes of PLY files.
    const named = coordinateSystemExtension(6);
    expect(await read(spzBytes({ version: 4, degree: 3, splats, extensions: named }))).toEqual(file);
  });
});

describe('refuses', () => {
  function changed(bytes: Uint8Array, at: number, ...values: number[]): Uint8Array {
    const result = Uint8Array.from(bytes);
    result.set(values, at);
    return result;
  }

  const v3 = fileOf(3, 1);
  const v4 = fileOf(4, 1);
  const badSystem = (version: number, system: number) =>
    fileOf(version, 0, { extensions: coordinateSystemExtension(system) });
  test.each([
    {
      name: 'version 0',
      bytes: changed(v3, 4, 0),
      code: 'bad-header',
      says: /version 0 is not known/,
      byte: 4,
    },
    { name: 'version 5', bytes: changed(v4, 4, 5), code: 'bad-header', says: /versions 1 to 4/, byte: 4 },
    { name: 'no splats', bytes: changed(v3, 8, 0), code: 'empty', says: /promises 0 splats/, byte: 8 },
    {
      name: 'absurdly many',
      bytes: changed(v4, 8, 255, 255, 255, 255),
      code: 'too-large',
      says: /4294967295 splats, more than maxSplats/,
      byte: 8,
    },
    {
      name: 'degree 5',
      bytes: changed(v3, 12, 5),
      code: 'bad-header',
      says: /degree 5; at most 4/,
      byte: 12,
    },
    { name: '32 bits', bytes: changed(v3, 13, 32), code: 'bad-header', says: /32 fractional bits/, byte: 13 },
    {
      name: 'a tree',
      bytes: changed(v3, 14, 0x80),
      code: 'unknown-format',
      says: /levels of detail/,
      byte: 14,
    },
    {
      name: 'five streams',
      bytes: changed(v4, 15, 5),
      code: 'bad-header',
      says: /5 streams; .* need 6/,
      byte: 15,
    },
    {
      name: 'an early table',
      bytes: changed(v4, 16, 31),
      code: 'bad-header',
      says: /byte 31, within/,
      byte: 16,
    },
    {
      name: 'a late table',
      bytes: changed(v4, 18, 9),
      code: 'truncated',
      says: /ends within the extensions/,
    },
    {
      name: 'another size',
      bytes: changed(v4, 40, 28),
      code: 'damaged',
      says: /27 bytes, but its table says 28/,
      byte: 32,
    },
    {
      name: 'a stream of too many bytes',
      bytes: changed(v4, 36, 9),
      code: 'truncated',
      says: /within the positions/,
    },
    { name: 'a damaged stream', bytes: changed(v4, 32 + 96, 0), code: 'damaged', says: /zstd/, byte: 128 },
    {
      name: 'more bytes',
      bytes: Uint8Array.of(...v4, 0),
      code: 'damaged',
      says: /after the last/,
      byte: v4.length,
    },
    {
      name: 'an extension that is too long',
      bytes: fileOf(4, 0, { extensions: [...littleEndian(7, 4), ...littleEndian(99, 4)] }),
      code: 'bad-header',
      says: /an extension has 99 bytes/,
      byte: 32,
    },
    {
      name: 'an extension that ends early',
      bytes: fileOf(3, 0, { extensions: [...littleEndian(7, 4), ...littleEndian(99, 4)] }),
      code: 'truncated',
      says: /ends within an extension/,
    },
    {
      name: 'axes of number 17',
      bytes: badSystem(4, 17),
      code: 'bad-header',
      says: /system \(17\)/,
      byte: 32,
    },
    {
      name: 'axes of number 17, at the end',
      bytes: badSystem(2, 17),
      code: 'bad-header',
      says: /system \(17\)/,
    },
    {
      name: 'axes of no number',
      bytes: fileOf(4, 0, { extensions: spzExtension(0xadbe0003, [6]) }),
      code: 'bad-header',
      says: /is not known/,
      byte: 32,
    },
  ])('$name', async ({ bytes, code, says, byte }) => {
    const error = await fileErrorOf(read(bytes));
    expect(error.code).toBe(code);
    expect(error.message).toMatch(says);
    if (byte !== undefined) expect(error.place).toEqual({ byte });
  });

  test.each(VERSIONS)('every beginning of a file of version %i', async (version) => {
    const extensions = [...spzExtension(7, [1, 2, 3]), ...coordinateSystemExtension(4)];
    const bytes = fileOf(version, 1, { extensions, splats: splatsOf(version, 1, 1) });
    const others = new Set<number>();
    for (let length = 4; length < bytes.length; length++) {
      const outcome = await read(bytes.subarray(0, length)).catch((error) => error);
      if (outcome.code !== 'truncated') others.add(length);
    }
    // Before version 4, nothing tells how many extensions there are: the last one takes 12 bytes.
    expect([...others]).toEqual(version < 4 ? [bytes.length - 12] : []);
  });

  test('files that unpack to far more than their bytes', async () => {
    const count = 2 ** 22;
    /** A frame of runs of 2^17 zeros. */
    const zeros = (byteCount: number) => {
      const runs = byteCount / 2 ** 17;
      const blocks = Array.from({ length: runs }, (_, i) => [i === runs - 1 ? 3 : 2, 0, 16, 0]);
      return [0x28, 0xb5, 0x2f, 0xfd, 0, 0x38, ...blocks.flat()];
    };
    const sizes = [9, 1, 3, 3, 4, 45].map((bytes) => bytes * count);
    const streams = sizes.map(zeros);
    const table = streams.flatMap((stream, i) => [
      ...littleEndian(stream.length, 8),
      ...littleEndian(sizes[i], 8),
    ]);
    const header = changed(fileOf(4, 3).subarray(0, 32), 8, ...littleEndian(count, 4));
    const bomb = Uint8Array.from([...header, ...table, ...streams.flat()]);
    const error = await fileErrorOf(read(bomb));
    expect(error).toMatchObject({ code: 'too-large' });
    expect(error.message).toMatch(/unpacks to .* are the limit/);
  });
});
