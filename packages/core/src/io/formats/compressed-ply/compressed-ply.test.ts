import { describe, expect, test } from 'vitest';
import { SplatFileError } from '../../../data/errors.ts';
import { readCoefficients } from '../../../data/packing/harmonics.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../../../data/splats/splat-set.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import {
  type Fixture,
  type FixtureElement,
  type FixtureProperty,
  plyBytes,
} from '../../../testing/ply-fixture.ts';
import { outcomeOf } from '../../../testing/read-damaged.ts';
import { expectSameSplats, rowsOf } from '../../../testing/rows-of.ts';
import { seededRandom } from '../../../testing/seeded-random.ts';
import { slowFile } from '../../../testing/slow-file.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { detectFormat } from '../detect.ts';

const SH_C0 = 0.28209479177387814;
const BOUNDS = ['x', 'y', 'z', 'scale_x', 'scale_y', 'scale_z', 'r', 'g', 'b'];

/** A splat as it is trained, with its base colour and opacity from 0 to 1. */
interface Splat {
  readonly position: readonly number[];
  readonly logScale: readonly number[];
  /** w, x, y, z, of length 1. */
  readonly rotation: readonly number[];
  readonly color: readonly number[];
  readonly opacity: number;
  /** As f_rest: all of red, then green, then blue. */
  readonly rest: readonly number[];
}

function randomSplats(count: number, degree: ShDegree): Splat[] {
  const random = seededRandom(degree + 1);
  const three = (from: number, to: number) => Array.from({ length: 3 }, () => from + (to - from) * random());
  return Array.from({ length: count }, () => {
    const rotation = Array.from({ length: 4 }, () => random() - 0.5);
    const length = Math.hypot(...rotation);
    return {
      position: three(-5, 20),
      logScale: three(-9, -2),
      rotation: rotation.map((part) => part / length),
      color: three(-0.3, 1.4),
      opacity: random(),
      rest: Array.from({ length: 3 * SH_REST_COEFFICIENTS[degree] }, () => 3 * (random() - 0.5)),
    };
  });
}

const unorm = (value: number, bits: number) => Math.round(value * (2 ** bits - 1));
const pack = ([a, b, c]: readonly number[]) => unorm(a, 11) * 2 ** 21 + unorm(b, 10) * 2 ** 11 + unorm(c, 11);

function packRotation(rotation: readonly number[]): number {
  const largest = rotation.reduce(
    (best, part, i) => (Math.abs(part) > Math.abs(rotation[best]) ? i : best),
    0,
  );
  const sign = Math.sign(rotation[largest]);
  const others = rotation.filter((_, i) => i !== largest);
  const fields = others.map((part) => unorm((sign * part) / Math.SQRT2 + 0.5, 10));
  return [largest, ...fields].reduce((packed, field) => packed * 1024 + field);
}

interface Encoding {
  readonly format?: Fixture['format'];
  /** As newer writers do; else colours are from 0 to 1. */
  readonly hasColorBounds?: boolean;
  readonly comments?: readonly string[];
}

function elementsOf(splats: readonly Splat[], hasColorBounds = true): FixtureElement[] {
  const stems = hasColorBounds ? BOUNDS : BOUNDS.slice(0, 6);
  const valuesOf = ({ position, logScale, color }: Splat) => [...position, ...logScale, ...color];
  const chunks = Array.from({ length: Math.ceil(splats.length / 256) }, (_, i) =>
    splats.slice(256 * i, 256 * (i + 1)).map(valuesOf),
  );
  const bound = (name: string, pick: (...values: number[]) => number): FixtureProperty[] =>
    stems.map((stem, i) => ({
      name: `${name}_${stem}`,
      type: 'float',
      values: chunks.map((rows) => pick(...rows.map((values) => values[i]))),
    }));
  const [min, max] = [bound('min', Math.min), bound('max', Math.max)];
  const fraction = (splat: Splat, row: number, i: number) => {
    if (i >= stems.length) return Math.max(0, Math.min(1, valuesOf(splat)[i]));
    const [from, to] = [min[i], max[i]].map(({ values }) => values[row >> 8] as number);
    return to > from ? (valuesOf(splat)[i] - from) / (to - from) : 0;
  };
  const packed = (name: string, value: (splat: Splat, row: number) => number): FixtureProperty => ({
    name,
    type: 'uint',
    values: splats.map(value),
  });
  const rest = Array.from({ length: splats[0]?.rest.length ?? 0 }, (_, i) => ({
    name: `f_rest_${i}`,
    type: 'uchar',
    values: splats.map((splat) => Math.max(0, Math.min(255, Math.trunc((splat.rest[i] / 8 + 0.5) * 256)))),
  }));
  const count = splats.length;
  return [
    { name: 'chunk', count: chunks.length, properties: [...min, ...max] },
    {
      name: 'vertex',
      count,
      properties: [
        packed('packed_position', (splat, row) => pack([0, 1, 2].map((i) => fraction(splat, row, i)))),
        packed('packed_rotation', ({ rotation }) => packRotation(rotation)),
        packed('packed_scale', (splat, row) => pack([3, 4, 5].map((i) => fraction(splat, row, i)))),
        packed('packed_color', (splat, row) =>
          [6, 7, 8]
            .map((i) => unorm(fraction(splat, row, i), 8))
            .concat(unorm(splat.opacity, 8))
            .reduce((sum, byte) => 256 * sum + byte),
        ),
      ],
    },
    ...(rest.length > 0 ? [{ name: 'sh', count, properties: rest }] : []),
  ];
}

function encode(
  splats: readonly Splat[],
  { format = 'binary_little_endian', hasColorBounds, comments }: Encoding = {},
): Uint8Array<ArrayBuffer> {
  return plyBytes({ format, comments, elements: elementsOf(splats, hasColorBounds) });
}

const read = (bytes: Uint8Array, shPrecision: 'f32' | 'u8' = 'f32') =>
  readSplats(bytes, { name: 'scene.compressed.ply', shPrecision });

async function failure(bytes: Uint8Array): Promise<SplatFileError> {
  const error = await fileErrorOf(read(bytes));
  expect(error.message.startsWith('scene.compressed.ply: ')).toBe(true);
  return error;
}

/** The largest difference between a set and the splats of its file, for each attribute. */
function errorsOf(set: Awaited<ReturnType<typeof read>>, splats: readonly Splat[]): Record<string, number> {
  const errors = { position: 0, logScale: 0, rotation: 0, color: 0, opacity: 0, sh: 0 };
  const note = (key: keyof typeof errors, difference: number) => {
    errors[key] = Math.max(errors[key], Math.abs(difference));
  };
  const perChannel = SH_REST_COEFFICIENTS[set.harmonics.degree];
  const sh = new Float64Array(3 * perChannel);
  for (const [i, splat] of splats.entries()) {
    for (let axis = 0; axis < 3; axis++) {
      note('position', set.positions[3 * i + axis] + set.origin[axis] - splat.position[axis]);
      note('logScale', set.logScales[3 * i + axis] - splat.logScale[axis]);
      note('color', set.colorDc[3 * i + axis] * SH_C0 + 0.5 - splat.color[axis]);
    }
    const dot = splat.rotation.reduce((sum, part, k) => sum + part * set.rotations[4 * i + k], 0);
    for (let k = 0; k < 4; k++)
      note('rotation', Math.sign(dot) * set.rotations[4 * i + k] - splat.rotation[k]);
    note('opacity', 1 / (1 + Math.exp(-set.opacityLogits[i])) - splat.opacity);
    readCoefficients(set.harmonics, i, sh);
    for (const [k, value] of splat.rest.entries())
      note('sh', sh[3 * (k % perChannel) + Math.floor(k / perChannel)] - value);
  }
  return errors;
}

/**
 * Half a step of each attribute: 10 bits over bounds of at most 25 (positions) and 7 (scales); a
 * byte over 1.7 and 1; for rotations, half a step of √2 / 1023 each, of which the largest
 * component, at least ½, takes up to the sum of three; for harmonics half of 8 / 256. Float32 adds
 * less than 1e-6.
 */
const BOUND = {
  position: 25 / 1023 / 2,
  logScale: 7 / 1023 / 2,
  rotation: (3 * Math.SQRT2) / 1023 / 2 / Math.SQRT1_2,
  color: 1.7 / 255 / 2,
  opacity: 1 / 255 / 2,
  sh: 8 / 256 / 2,
};

describe('reads', () => {
  for (const format of ['binary_little_endian', 'binary_big_endian'] as const) {
    test.each([0, 1, 2, 3] as const)(`${format}, SH degree %i`, async (degree) => {
      const splats = randomSplats(300, degree);
      const set = await read(encode(splats, { format }));
      expect(set).toMatchObject({ count: 300, dropped: {}, harmonics: { degree } });
      expect(set.isAntialiased).toBeUndefined();
      for (const [key, error] of Object.entries(errorsOf(set, splats)))
        expect(error, key).toBeLessThan(BOUND[key as keyof typeof BOUND] + 2e-6);
    });
  }

  test('every number of the packed fields, by hand', async () => {
    const splat = (position: number, rotation: number, scale: number, color: number) =>
      [position, rotation, scale, color] as const;
    const rows = [splat(0, 0, 0, 0), splat(2 ** 32 - 1, 2 ** 30 + 511, 2 ** 32 - 1, 0xff8000ff)];
    const elements = elementsOf(randomSplats(2, 0), false);
    const chunk = elements[0].properties.map((property, i) => ({ ...property, values: [i < 6 ? 0 - i : i] }));
    const vertex = elements[1].properties.map((property, i) => ({
      ...property,
      values: rows.map((row) => row[i]),
    }));
    const bytes = plyBytes({
      format: 'binary_little_endian',
      elements: [
        { ...elements[0], properties: chunk },
        { ...elements[1], properties: vertex },
      ],
    });
    const { values: found } = await rowsOf(new File([bytes], 'a.compressed.ply'));
    const [first, second] = [found.subarray(0, 14), found.subarray(14)];
    expect([...first.subarray(0, 6)]).toEqual([0, -1, -2, -3, -4, -5]);
    expect([...second.subarray(0, 6)]).toEqual([6, 7, 8, 9, 10, 11]);
    // Three times −√½ leave nothing for the largest.
    expect([...first.subarray(6, 10)]).toEqual([0, ...Array(3).fill(Math.fround(-Math.SQRT1_2))]);
    const [a, c] = [-Math.SQRT1_2, (511 / 1023 - 0.5) * Math.SQRT2];
    expect([...second.subarray(6, 10)]).toEqual(
      [a, Math.sqrt(Math.max(0, 1 - 2 * a * a - c * c)), a, c].map(Math.fround),
    );
    expect([first[ROW_SLOT.opacity], second[ROW_SLOT.opacity]]).toEqual([-Infinity, Infinity]);
    expect([...first.subarray(11)]).toEqual(Array(3).fill(Math.fround(-0.5 / SH_C0)));
    expect([...second.subarray(11)]).toEqual([0.5, 128 / 255 - 0.5, -0.5].map((c) => Math.fround(c / SH_C0)));
  });

  test('harmonics of degree 4 are left out, with a note', async () => {
    const splats = randomSplats(3, 3);
    const [chunk, vertex, sh] = elementsOf(splats);
    const inFile = (i: number) => 24 * Math.floor(i / 15) + (i % 15);
    const kept = sh.properties.map((property, i) => ({ ...property, name: `f_rest_${inFile(i)}` }));
    const above = Array.from({ length: 72 }, (_, i) => i)
      .filter((i) => i % 24 >= 15)
      .map((i) => ({ name: `f_rest_${i}`, type: 'uchar', values: [255, 0, 7] }));
    const elements = [chunk, vertex, { ...sh, properties: [...above, ...kept] }];
    const set = await read(plyBytes({ format: 'binary_little_endian', elements }));
    expect(set.harmonics.degree).toBe(3);
    expect(errorsOf(set, splats).sh).toBeLessThan(BOUND.sh + 2e-6);
    expect(set.fileFacts?.notes).toEqual(['Its harmonics of degree 4 are left out.']);
  });

  test('bounds of −∞, of flat splats whose log scales were not clamped', async () => {
    const [chunk, vertex] = elementsOf(randomSplats(2, 0));
    const properties = chunk.properties.map((property) =>
      ['min_scale_x', 'max_scale_x', 'min_scale_y'].includes(property.name)
        ? { ...property, values: [Number.NEGATIVE_INFINITY] }
        : property,
    );
    const elements = [{ ...chunk, properties }, vertex];
    const set = await read(plyBytes({ format: 'binary_little_endian', elements }));
    expect(set).toMatchObject({ count: 2, dropped: {} });
    expect([set.logScales[0], set.logScales[3]]).toEqual([-20, -20]);
    expect(Math.min(set.logScales[1], set.logScales[4])).toBe(-20);
  });

  test('files without bounds of colours', async () => {
    const splats = randomSplats(300, 1);
    const set = await read(encode(splats, { hasColorBounds: false }));
    const clamped = splats.map((splat) => ({
      ...splat,
      color: splat.color.map((c) => Math.max(0, Math.min(1, c))),
    }));
    expect(errorsOf(set, clamped).color).toBeLessThan(1 / 255 / 2 + 1e-6);
  });

  test('properties in any order, among others, in elements of any order', async () => {
    const splats = randomSplats(300, 1);
    const expected = await read(encode(splats));
    const [chunk, vertex, sh] = elementsOf(splats).map((element) => {
      const extra = { name: 'extra', type: 'double', values: Array(element.count).fill(7) };
      return { ...element, properties: [extra, ...element.properties.toReversed()] };
    });
    const other: FixtureElement = {
      name: 'other',
      count: 3,
      properties: [{ name: 'id', type: 'short', values: [1, 2, 3] }],
    };
    const faces: FixtureElement = {
      name: 'face',
      count: 1,
      properties: [{ name: 'i', type: 'int', countType: 'uchar', values: [[1, 2]] }],
    };
    const elements = [chunk, other, sh, vertex, faces];
    const bytes = plyBytes({ format: 'binary_little_endian', elements });
    expect(await read(bytes)).toEqual(expected);
  });

  for (const format of ['binary_little_endian', 'binary_big_endian'] as const) {
    test.each([0, 1, 2, 3] as const)(
      `${format}, SH degree %i: the GPU gets the same splats`,
      async (degree) => {
        const splats = randomSplats(600, degree).map((splat) => ({
          ...splat,
          position: splat.position.map((value) => value + 1e5),
        }));
        const bytes = encode(splats, { format });
        const set = await read(bytes);
        // Pieces of one chunk.
        const rows = await rowsOf(new File([bytes], 'a.compressed.ply'), {}, 1);
        expect(rows.layout).toMatchObject({ count: 600, shDegree: degree, origin: set.origin });
        expect(rows.layout.strideBytes).toBe(56 + [0, 9, 24, 45][degree]);
        expectSameSplats(rows, set);
      },
    );
  }

  test('the GPU gets the same splats of rows among other properties', async () => {
    const [chunk, vertex, sh] = elementsOf(randomSplats(300, 1));
    for (const [type, strideBytes] of [
      // Bytes of the file's rows are copied with them, but only if they stay below floats.
      ['short', 56 + 11],
      ['double', 56 + 17],
    ] as const) {
      const extra = { name: 'extra', type, values: Array(300).fill(7) };
      const properties = [extra, ...sh.properties.toReversed()];
      const elements = [chunk, vertex, { ...sh, properties }];
      const bytes = plyBytes({ format: 'binary_little_endian', elements });
      const { layout, values } = await rowsOf(new File([bytes], 'a.compressed.ply'));
      expect(layout.strideBytes).toBe(strideBytes);
      expectSameSplats({ layout, values }, await read(bytes));
    }
    const extras = Array.from({ length: 4 }, (_, i) => ({
      name: `extra_${i}`,
      type: 'double',
      values: Array(300).fill(7),
    }));
    const wide = [chunk, vertex, { ...sh, properties: [...extras, ...sh.properties] }];
    const bytes = plyBytes({ format: 'binary_little_endian', elements: wide });
    const { layout, values } = await rowsOf(new File([bytes], 'a.compressed.ply'));
    expect(layout.byteHarmonics).toBeUndefined();
    expectSameSplats({ layout, values }, await read(bytes));
  });

  test('every byte of harmonics', async () => {
    const [chunk, vertex, sh] = elementsOf(randomSplats(256, 1));
    const everyByte = Array.from({ length: 256 }, (_, byte) => byte);
    const properties = sh.properties.map((property) => ({ ...property, values: everyByte }));
    const bytes = plyBytes({
      format: 'binary_little_endian',
      elements: [chunk, vertex, { ...sh, properties }],
    });
    const { values } = await rowsOf(new File([bytes], 'a.compressed.ply'));
    const expected = everyByte.map((byte) => [-4, 4][[0, 255].indexOf(byte)] ?? (byte + 0.5) / 32 - 4);
    for (const [row, value] of expected.entries())
      expect([...values.subarray(23 * row + 14, 23 * (row + 1))]).toEqual(Array(9).fill(value));
  });

  test.each([
    ['the harmonics of others', 2, 4 * 14 + 24],
    ['others', 0, 4 * 14],
  ] as const)('rows go to the GPU while %s are on their way', async (_, degree, rowBytes) => {
    const bytes = encode(randomSplats(600, degree));
    const pieceBytes = 256 * rowBytes;
    const lastAt = bytes.length - 100;
    let taken = 0;
    let takenBeforeLast = -1;
    const file = slowFile(
      'a.compressed.ply',
      bytes,
      [bytes.subarray(0, lastAt), bytes.subarray(lastAt)],
      async () => {
        // The last bytes come when nothing else can be done.
        for (let turn = 0; turn < 10; turn++) await new Promise((resolve) => setImmediate(resolve));
        takenBeforeLast = taken;
      },
    );
    const { values } = await rowsOf(file, {}, pieceBytes, (rowCount) => {
      taken += rowCount;
    });
    expect(takenBeforeLast).toBe(512);
    const all = await rowsOf(new File([bytes], 'a.compressed.ply'), {}, pieceBytes);
    expect(Buffer.from(values.buffer).equals(Buffer.from(all.values.buffer))).toBe(true);
  });

  test('a chunk with a bound that is not finite loses its splats only', async () => {
    const elements = elementsOf(randomSplats(600, 0));
    const properties = elements[0].properties.map((property) =>
      property.name === 'max_y' ? { ...property, values: [20, Number.NaN, 20] } : property,
    );
    const bytes = plyBytes({
      format: 'binary_little_endian',
      elements: [{ ...elements[0], properties }, elements[1]],
    });
    expect(await read(bytes)).toMatchObject({ count: 344, dropped: { 'non-finite-position': 256 } });
  });

  test('facts from the header, in either way of reading', async () => {
    const comments = ['comment Generated by SuperSplat 2.6.2', 'comment SplatRenderMode: mip'];
    const bytes = encode(randomSplats(2, 0), { comments });
    const expected = {
      isAntialiased: true,
      fileFacts: { format: 'compressed-ply', variant: 'binary_little_endian', writer: 'SuperSplat 2.6.2' },
    };
    expect(await read(bytes)).toMatchObject(expected);
    expect((await rowsOf(new File([bytes], 'a.ply'))).layout).toMatchObject(expected);
  });

  test('it is told from other PLY by its first bytes, whatever its name', () => {
    const of = (bytes: Uint8Array) => detectFormat(bytes.subarray(0, 512), 'a', ['a.ply']).name;
    const bytes = encode(randomSplats(2, 0), { comments: ['comment Generated by SuperSplat 2.6.2'] });
    expect(of(bytes)).toBe('compressed-ply');
    const elements = elementsOf(randomSplats(2, 0));
    const plain = { ...elements[0], properties: [{ name: 'id', type: 'int', values: [1] }] };
    expect(of(plyBytes({ format: 'binary_little_endian', elements: [plain, elements[1]] }))).toBe('ply');
  });
});

describe('refuses', () => {
  test.each([
    [2, 'the harmonics of its 600 splats'],
    [0, 'its 600 splats'],
  ] as const)(
    'a file of degree %d that ends before the size that it has, while its rows are on their way to the GPU',
    async (degree, place) => {
      const bytes = encode(randomSplats(600, degree));
      const error = await fileErrorOf(
        rowsOf(slowFile('a.compressed.ply', bytes, [bytes.slice(0, bytes.length - 50)])),
      );
      expect(error.code).toBe('truncated');
      expect(error.message).toContain(`ends within ${place}`);
      expect(error.place.byte).toBe(bytes.length - 50);
    },
  );

  const elements = elementsOf(randomSplats(300, 1));
  const [chunk, vertex, sh] = elements;
  const bytesOf = (...changed: FixtureElement[]) =>
    plyBytes({ format: 'binary_little_endian', elements: changed });
  const without = (element: FixtureElement, name: string) => ({
    ...element,
    properties: element.properties.filter((property) => property.name !== name),
  });
  const renamed = (element: FixtureElement, name: string, change: Partial<FixtureProperty>) => ({
    ...element,
    properties: element.properties.map((property) =>
      property.name === name ? { ...property, ...change } : property,
    ),
  });
  const fewer = (element: FixtureElement, count: number) => ({ ...element, count });
  test.each([
    ['text', plyBytes({ format: 'ascii', elements }), 'bad-header', /such files are binary/],
    ['no vertex', bytesOf(chunk, sh), 'bad-header', /without an element vertex/],
    [
      'no packed_scale',
      bytesOf(chunk, without(vertex, 'packed_scale')),
      'bad-property',
      /packed_scale is missing/,
    ],
    ['no min_z', bytesOf(chunk && without(chunk, 'min_z'), vertex), 'bad-property', /min_z is missing/],
    ['no max_b', bytesOf(without(chunk, 'max_b'), vertex), 'bad-property', /max_b is missing/],
    ['no f_rest_3', bytesOf(chunk, vertex, without(sh, 'f_rest_3')), 'bad-property', /8 f_rest properties/],
    [
      'f_rest_30 instead of f_rest_3',
      bytesOf(chunk, vertex, renamed(sh, 'f_rest_3', { name: 'f_rest_30' })),
      'bad-property',
      /f_rest_3 is missing/,
    ],
    [
      'bounds in doubles',
      bytesOf(renamed(chunk, 'min_x', { type: 'double' }), vertex),
      'bad-property',
      /min_x is of type float64; it must be float32/,
    ],
    [
      'a list',
      bytesOf(chunk, renamed(vertex, 'packed_color', { countType: 'uchar', values: Array(300).fill([1]) })),
      'bad-property',
      /packed_color is a list/,
    ],
    [
      'a property twice',
      bytesOf(chunk, { ...vertex, properties: [...vertex.properties, vertex.properties[0]] }),
      'bad-property',
      /packed_position is declared twice/,
    ],
    ['too few chunks', bytesOf(fewer(chunk, 1), vertex), 'damaged', /300 splats .* more than 1 chunks/],
    [
      'fewer harmonics',
      bytesOf(chunk, vertex, fewer(sh, 299)),
      'damaged',
      /300 splats, but harmonics of 299/,
    ],
    ['no splats', bytesOf(fewer(chunk, 0), fewer(vertex, 0)), 'empty', /0 splats/],
  ] as const)('%s', async (_, bytes, code, says) => {
    const error = await failure(bytes);
    expect(error.message).toMatch(says);
    expect(error.code).toBe(code);
  });

  test('counts that nothing can hold', async () => {
    const text = Buffer.from(encode(randomSplats(300, 1))).toString('latin1');
    const changed = text
      .replace('element chunk 2', 'element chunk 20000000')
      .replaceAll(/element (vertex|sh) 300/g, 'element $1 4000000000');
    const error = await failure(Buffer.from(changed, 'latin1'));
    expect(error.code).toBe('too-large');
    const before = process.memoryUsage().arrayBuffers;
    const options = { maxSplats: Number.POSITIVE_INFINITY, name: 'a.compressed.ply' };
    const stream = new Blob([Buffer.from(changed, 'latin1')]).stream();
    await expect(readSplats(stream, options)).rejects.toMatchObject({ code: 'truncated' });
    expect(process.memoryUsage().arrayBuffers - before).toBeLessThan(16e6);
  });

  test('a PLY reader that meets one says what it is', async () => {
    const comments = Array(80).fill(`comment ${'x'.repeat(60)}`);
    const error = await failure(encode(randomSplats(2, 0), { comments }));
    expect(error.code).toBe('unknown-format');
    expect(error.message).toMatch(/compressed PLY \(it has packed_position\) with an unusual header/);
  });

  test('every truncation', async () => {
    const bytes = encode(randomSplats(3, 1));
    const body = Buffer.from(bytes).indexOf('end_header') + 11;
    for (let length = 0; length < bytes.length; length += length < body ? 10 : 1) {
      // Once with a size that is known, and in the body without.
      for (const chunkBytes of length < body ? [undefined] : [undefined, 4096]) {
        const outcome = await outcomeOf(bytes.slice(0, length), 'a.compressed.ply', chunkBytes);
        expect(outcome).toBeInstanceOf(SplatFileError);
        if (length >= body) expect((outcome as SplatFileError).code).toBe('truncated');
      }
    }
  });
});
