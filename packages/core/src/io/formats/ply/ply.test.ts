import fc from 'fast-check';
import { describe, expect, test, vi } from 'vitest';
import { toHalfBits } from '../../../data/layout/half.ts';
import { type Harmonics, type PackedHarmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { packCloud } from '../../../data/packing/packed-cloud.ts';
import { colorOf } from '../../../data/splats/color-values.ts';
import { SH_REST_COEFFICIENTS, type ShDegree, type SplatSet } from '../../../data/splats/splat-set.ts';
import { splatsAt } from '../../../features/motion/splats-at.data.ts';
import { expectSamePicture } from '../../../testing/expect-same-picture.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { movingSplats } from '../../../testing/moving-splats.ts';
import {
  CORE_NAMES,
  chunked,
  distinctValue,
  type Fixture,
  type FixtureElement,
  type FixtureProperty,
  plyBytes,
  splatElement,
  splatNames,
} from '../../../testing/ply-fixture.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { rowsOf } from '../../../testing/rows-of.ts';
import { zipFiles } from '../../containers/write-zip.ts';
import { readSplatPieces, readSplats } from '../../loading/read-splats.ts';
import { SNIFF_BYTES } from '../read-format.ts';
import { PieceFacts } from '../rows/piece-facts.ts';
import { writeSplatPieces, writeSplats } from '../writers.ts';
import { openPlyRows } from './ply-rows.ts';
import { encodePly } from './write-ply.ts';

const FORMATS = ['ascii', 'binary_little_endian', 'binary_big_endian'] as const;
const LE = 'binary_little_endian';

const read = (bytes: Uint8Array, shPrecision: 'f32' | 'f16' | 'u8' = 'f32') =>
  readSplats(bytes, { shPrecision });
const readFixture = (...elements: FixtureElement[]) => read(plyBytes({ format: LE, elements }));

/** Text header and body, as a file would have them. */
const textFile = (text: string) => new TextEncoder().encode(text);

/** A vertex element whose property `name` is another. */
function withProperty(
  element: FixtureElement,
  name: string,
  change: Partial<FixtureProperty>,
): FixtureElement {
  const properties = element.properties.map((property) =>
    property.name === name ? { ...property, ...change } : property,
  );
  return { ...element, properties };
}

/** A set's value for one property of the file. */
function valueIn(set: SplatSet<Harmonics>, name: string, index: number): number {
  const axis = 'xyz'.indexOf(name);
  if (axis >= 0) return set.positions[3 * index + axis] + set.origin[axis];
  const number = Number(name.split('_').at(-1));
  if (name.startsWith('scale')) return set.logScales[3 * index + number];
  if (name.startsWith('rot')) return set.rotations[4 * index + number];
  if (name === 'opacity') return set.opacityLogits[index];
  if (name.startsWith('f_dc')) return set.colorDc[3 * index + number];
  const coefficients = SH_REST_COEFFICIENTS[set.harmonics.degree];
  const values = new Float64Array(3 * coefficients);
  readCoefficients(set.harmonics, index, values);
  return values[3 * (number % coefficients) + Math.floor(number / coefficients)];
}

function expectDistinctValues(set: SplatSet<PackedHarmonics>, count: number, degree: ShDegree): void {
  expect(set.count).toBe(count);
  expect(set.harmonics.degree).toBe(degree);
  expect([...set.fileIndices]).toEqual(Array.from({ length: count }, (_, i) => i));
  for (const name of splatNames(degree)) {
    const found = Array.from({ length: count }, (_, row) => valueIn(set, name, row));
    expect(found, name).toEqual(Array.from({ length: count }, (_, row) => distinctValue(name, row)));
  }
}

describe('reads', () => {
  for (const format of FORMATS) {
    test.each([0, 1, 2, 3] as const)(`${format}, SH degree %i`, async (degree) => {
      expectDistinctValues(await read(plyBytes({ format, elements: [splatElement(5, degree)] })), 5, degree);
    });

    test(`${format}: further elements, properties, lists and comments are passed over`, async () => {
      const splats = splatElement(3, 1);
      const extra: FixtureProperty[] = [
        { name: 'nx', type: 'double', values: [1, 2, 3] },
        { name: 'red', type: 'uchar', values: [255, 0, 7] },
        { name: 'neighbours', type: 'int', countType: 'uchar', values: [[], [4], [1, 2, 3]] },
      ];
      const properties = splats.properties.flatMap((property, i) =>
        i % 5 === 1 ? [extra[(i - 1) / 5], property] : [property],
      );
      const face: FixtureElement = {
        name: 'face',
        count: 2,
        properties: [
          {
            name: 'vertex_indices',
            type: 'ushort',
            countType: 'int',
            values: [
              [0, 1, 2],
              [2, 1, 0, 3],
            ],
          },
        ],
      };
      const camera: FixtureElement = {
        name: 'camera',
        count: 2,
        properties: [{ name: 'fov', type: 'short', values: [-60, 90] }],
      };
      const nothing: FixtureElement = { name: 'nothing', count: 4, properties: [] };
      const elements = [
        nothing,
        face,
        camera,
        { ...splats, properties: properties.filter(Boolean) },
        { ...face, name: 'more' },
      ];
      const comments = ['comment made by hand', 'obj_info a b  c', 'comment end_header is not here', ''];
      for (const lineEnd of ['\n', '\r\n', '\r']) {
        expectDistinctValues(await read(plyBytes({ format, elements, comments, lineEnd })), 3, 1);
      }
    });
  }

  test('a CR-only header whose body starts with the byte LF', async () => {
    const element = { ...splatElement(1) };
    const properties = [{ name: 'first', type: 'uchar', values: [10] }, ...element.properties];
    const bytes = plyBytes({ format: LE, elements: [{ ...element, properties }], lineEnd: '\r' });
    expectDistinctValues(await read(bytes), 1, 0);
  });

  test.each([
    'char',
    'int8',
    'uchar',
    'uint8',
    'short',
    'int16',
    'int',
    'int32',
    'uint',
    'uint32',
    'double',
    'float64',
    'float32',
  ])('values of type %s are plain numbers', async (type) => {
    const values = type.startsWith('u') ? [0, 1, 100] : [-100, 0, 127];
    for (const format of FORMATS) {
      const properties = splatNames(0).map((name) => ({ name, type, values }));
      const set = await read(plyBytes({ format, elements: [{ name: 'vertex', count: 3, properties }] }));
      for (const name of splatNames(0))
        expect(
          [0, 1, 2].map((i) => valueIn(set, name, i)),
          name,
        ).toEqual(values);
    }
  });

  test.each(['ushort', 'uint16'])(
    'values of type %s are plain numbers in text, and beside others',
    async (type) => {
      const values = [0, 1, 100];
      const properties = splatNames(0).map((name) => ({ name, type, values }));
      const beside = properties.map((property) =>
        property.name === 'y' ? { ...property, type: 'float' } : property,
      );
      for (const [format, columns] of [
        ['ascii', properties],
        [LE, beside],
        ['binary_big_endian', beside],
      ] as const) {
        const set = await read(
          plyBytes({ format, elements: [{ name: 'vertex', count: 3, properties: columns }] }),
        );
        for (const name of splatNames(0))
          expect(
            [0, 1, 2].map((i) => valueIn(set, name, i)),
            name,
          ).toEqual(values);
      }
    },
  );

  test.each(['half', 'float16', 'ushort', 'uint16'])(
    'binary files with nothing but %s hold halves',
    async (type) => {
      const splats = splatElement(5, 3);
      const properties = splats.properties.map((property) => ({
        ...property,
        type: 'ushort',
        values: property.values.map((value) => toHalfBits(value as number)),
      }));
      // Unneeded properties may have any value.
      const extra: FixtureProperty = { name: 'nx', type: 'float', values: [1, 2, 3, 4, 5] };
      for (const format of [LE, 'binary_big_endian'] as const) {
        const bytes = plyBytes({ format, elements: [{ ...splats, properties: [extra, ...properties] }] });
        const text = Buffer.from(bytes).toString('latin1').replaceAll('property ushort', `property ${type}`);
        expectDistinctValues(await read(Buffer.from(text, 'latin1')), 5, 3);
      }
    },
  );

  test('halves beside floats; halves that are not finite', async () => {
    const splats = withProperty(splatElement(4), 'opacity', {
      type: 'ushort',
      values: [0x3c00, 0xfc00, 0x7e00, 0x0001],
    });
    const bytes = plyBytes({ format: LE, elements: [splats] });
    const text = Buffer.from(bytes).toString('latin1').replace('ushort opacity', 'half opacity');
    const set = await read(Buffer.from(text, 'latin1'));
    expect([...set.opacityLogits]).toEqual([1, Number.NEGATIVE_INFINITY, 2 ** -24]);
    expect(set.dropped).toEqual({ 'non-finite-opacity': 1 });
  });

  test.each(FORMATS)('%s of 2DGS, without scale_2: flat, and said so', async (format) => {
    const splats = splatElement(3, 1);
    const properties = splats.properties.filter(({ name }) => name !== 'scale_2');
    const bytes = plyBytes({ format, elements: [{ ...splats, properties }] });
    const set = await read(bytes);
    expect(set).toMatchObject({
      count: 3,
      dropped: {},
      fileFacts: { notes: [expect.stringMatching(/2DGS/)] },
    });
    for (let i = 0; i < 3; i++) {
      const expected = ['scale_0', 'scale_1'].map((name) => distinctValue(name, i));
      expect([...set.logScales.subarray(3 * i, 3 * i + 3)]).toEqual([...expected, -20]);
    }
    const { geometry } = packCloud(set, { geometryPrecision: 'f32' });
    expect(new Float32Array(geometry.words.buffer).every(Number.isFinite)).toBe(true);
  });

  test.each([
    ['SplatRenderMode: default', false],
    ['SplatRenderMode: mip', true],
    ['splatrendermode:  MIP', true],
    ['SplatRenderMode: 2dgs', false],
    ['SplatRenderMode: other', undefined],
    ['antialiased 0', false],
    ['antialiased 1', true],
    ['antialiased 2', undefined],
    ['not antialiased 1', undefined],
    ['antialiased 1\ncomment SplatRenderMode: default', false],
  ] as const)('"comment %s" says of an antialias filter: %s', async (comment, isAntialiased) => {
    const fixture = { elements: [splatElement(2)], comments: [`comment ${comment}`] };
    for (const format of FORMATS)
      expect((await read(plyBytes({ ...fixture, format }))).isAntialiased).toBe(isAntialiased);
    const bytes = plyBytes({ ...fixture, format: LE });
    expect((await rowsOf(new File([bytes], 'a.ply'))).layout.isAntialiased).toBe(isAntialiased);
    const set = await read(bytes);
    expect(await read(encodePly(set))).toEqual(set);
  });

  test('facts from the header', async () => {
    const comments = ['comment Generated by SuperSplat 2.6.2'];
    const bytes = plyBytes({ format: LE, elements: [splatElement(2)], comments });
    const expected = { format: 'ply', variant: LE, writer: 'SuperSplat 2.6.2' };
    expect((await read(bytes)).fileFacts).toEqual(expected);
    expect((await rowsOf(new File([bytes], 'a.ply'))).layout.fileFacts).toEqual(expected);
    const plain = await read(plyBytes({ format: 'ascii', elements: [splatElement(2)] }));
    expect(plain.fileFacts).toEqual({ format: 'ply', variant: 'ascii' });
  });

  test('whitespace, blank lines, and every spelling of numbers in text', async () => {
    const values = '1 -2 +3 .5 1. 1e2 -1E-2 0 0 0 1 0 0 0'.split(' ');
    const header = plyBytes({ format: 'ascii', elements: [splatElement(0)] });
    const text = `${new TextDecoder().decode(header).replace('vertex 0', 'vertex 2')}\n  ${values.join(' \t ')}  \r\n\r\n\n${values.join(' ')}`;
    const set = await read(textFile(text));
    expect(set.count).toBe(2);
    expect(set.origin).toEqual([1, -2, 3]);
    expect([...set.colorDc.subarray(3)]).toEqual([0.5, 1, 100]);
    expect(set.opacityLogits[0]).toBe(Math.fround(-0.01));
  });

  test('a last line without a line end, longer than all before it', async () => {
    const text = new TextDecoder('latin1').decode(plyBytes({ format: 'ascii', elements: [splatElement(1)] }));
    const long = text.trimEnd().replace(/\S+$/, `${'0'.repeat(5000)}7`);
    const bytes = textFile(long);
    for (const source of [bytes, chunked(bytes, [3])])
      expect((await readSplats(source)).rotations[3]).toBe(7);
  });

  test('bytes after the splats are ignored', async () => {
    const bytes = plyBytes({ format: LE, elements: [splatElement(2)] });
    expect((await read(new Uint8Array([...bytes, 1, 2, 3]))).count).toBe(2);
  });
});

/**
 * @fault Files: harmonics above degree 3, in PLY, compressed PLY, SPZ or glTF
 * @consequence the bands up to 3 are read, and `fileFacts.notes` says which are left out
 */
describe('harmonics above degree 3', () => {
  /** Bands up to 3 as in a file of degree 3, and 0.5 in those above. */
  function withBands(fileDegree: number, count: number): FixtureElement {
    const perChannel = (fileDegree + 1) ** 2 - 1;
    const all = splatElement(count, 3);
    const inFile = (name: string) => {
      const k = Number(name.slice('f_rest_'.length));
      return `f_rest_${perChannel * Math.floor(k / 15) + (k % 15)}`;
    };
    const kept = all.properties.map((property) =>
      property.name.startsWith('f_rest_') ? { ...property, name: inFile(property.name) } : property,
    );
    const names = new Set(kept.map(({ name }) => name));
    const others = Array.from({ length: 3 * perChannel }, (_, i) => `f_rest_${i}`)
      .filter((name) => !names.has(name))
      .map((name) => ({ name, type: 'float', values: Array(count).fill(0.5) }));
    return { ...all, properties: [...kept, ...others] };
  }

  for (const format of FORMATS) {
    test.each([
      [4, 'Its harmonics of degree 4 are left out.'],
      [5, 'Its harmonics of degrees 4 to 5 are left out.'],
      [7, 'Its harmonics of degrees 4 to 7 are left out.'],
    ])(`${format}: those of degree %i are left out, with a note`, async (fileDegree, note) => {
      const bytes = plyBytes({ format, elements: [withBands(fileDegree, 4)] });
      const set = await read(bytes);
      expectDistinctValues(set, 4, 3);
      expect(set.fileFacts?.notes).toEqual([note]);
    });
  }

  test('rows of a part of a file keep them out as well', async () => {
    const file = new File([plyBytes({ format: LE, elements: [withBands(4, 6)] })], 'a.ply');
    const rows = await openPlyRows(file, 'a.ply');
    expect(rows).toMatchObject({ count: 6, shDegree: 3, strideBytes: 4 * (14 + 72) });
    const set = await readSplats(rows.fileOf([[2, 3]]), { shPrecision: 'f32' });
    expect(valueIn(set, 'f_rest_44', 0)).toBe(distinctValue('f_rest_44', 2));
    expect(set.fileFacts?.notes).toHaveLength(1);
  });
});

/**
 * @fault Files: a PLY of Mip-Splatting with its 3D filter beside scales and opacities
 * @consequence the filter is fused, also near opacities of 0 and 1 and with flat splats; `fileFacts.notes`
 *   says so
 */
describe('filter_3D of Mip-Splatting', () => {
  const SCALES = [-3, -2.5, -4];
  /** A splat of opacity σ(logit) with the filter, its place in the file first. */
  const filtered = (
    logit: number,
    filter: number,
    scales: readonly number[] = SCALES,
    type = 'float',
  ): FixtureElement => {
    const value = (name: string) => {
      if (name === 'opacity') return logit;
      return name.startsWith('scale_') ? scales[Number(name.at(-1))] : 0.5;
    };
    const splats = splatElement(1, 1, value);
    const property = { name: 'filter_3D', type, values: [filter] };
    return { ...splats, properties: [property, ...splats.properties] };
  };
  /** Scales and opacity by the trainer's own formulas, in float64. */
  const fused = (logit: number, filter: number, scales: readonly number[]) => {
    const squares = scales.map((scale) => Math.exp(2 * scale));
    const sums = squares.map((square) => square + filter * filter);
    const product = (values: readonly number[]) => values.reduce((all, value) => all * value);
    return {
      logScales: sums.map((sum) => Math.log(sum) / 2),
      opacity: Math.sqrt(product(squares) / product(sums)) / (1 + Math.exp(-logit)),
    };
  };

  for (const format of FORMATS) {
    test.each([
      [1.5, 0.05],
      [-4, 2],
      [9, 0.001],
    ])(`${format}: logit %f, filter %f`, async (logit, filter) => {
      const set = await read(plyBytes({ format, elements: [filtered(logit, filter)] }));
      const expected = fused(logit, Math.fround(filter), SCALES);
      for (const axis of [0, 1, 2]) expect(set.logScales[axis]).toBeCloseTo(expected.logScales[axis], 6);
      expect(1 / (1 + Math.exp(-set.opacityLogits[0]))).toBeCloseTo(expected.opacity, 7);
      expect(set.fileFacts?.notes).toEqual([expect.stringContaining('filter_3D')]);
      expect(set.dropped).toEqual({});
    });
  }

  test('a picture of it is that of the fused splats', async () => {
    const raw = randomSplats({ count: 60, shDegree: 0, halfExtent: 0.6 });
    const filters = Float32Array.from({ length: raw.count }, (_, i) => 0.01 + (i % 7) / 50);
    const opacityLogits = raw.opacityLogits.slice();
    const logScales = raw.logScales.slice();
    for (let i = 0; i < raw.count; i++) {
      const own = fused(raw.opacityLogits[i], filters[i], [...raw.logScales.subarray(3 * i, 3 * i + 3)]);
      logScales.set(own.logScales, 3 * i);
      opacityLogits[i] = Math.log(own.opacity / (1 - own.opacity));
    }
    const element = splatElement(raw.count, 0, (name, row) => valueIn(raw, name, row));
    const property = { name: 'filter_3D', type: 'float', values: [...filters] };
    const found = await readFixture({ ...element, properties: [...element.properties, property] });
    expectSamePicture(found, { ...raw, opacityLogits, logScales }, 100);
    expect(() => expectSamePicture(found, raw, 40)).toThrow();
  });

  test('splats without one, with a flat one, and of any size', async () => {
    const splatOf = async (...given: Parameters<typeof filtered>) => {
      const { logScales, opacityLogits, dropped } = await readFixture(filtered(...given));
      expect(dropped).toEqual({});
      return { logScales: [...logScales], logit: opacityLogits[0] };
    };
    // A filter of 0 changes nothing.
    expect(await splatOf(60, 0)).toEqual({ logScales: SCALES, logit: 60 });
    expect(await splatOf(Number.POSITIVE_INFINITY, 0)).toEqual({ logScales: SCALES, logit: Infinity });
    // What is flat has no volume, which is all of the opacity.
    const flat = await splatOf(2, 1, [-Infinity, -40, 0]);
    expect(flat.logScales[0]).toBe(0);
    expect(flat.logit).toBe(Number.NEGATIVE_INFINITY);
    expect(await splatOf(2, 0, [-Infinity, -2, -2])).toEqual({ logScales: [-Infinity, -2, -2], logit: 2 });
    // Opacities near 0 and 1, which linear values would round to that.
    const share = 3 * Math.log(1 / Math.SQRT2);
    expect((await splatOf(-90, 1, [0, 0, 0])).logit).toBeCloseTo(-90 + share, 4);
    expect((await splatOf(90, 1, [0, 0, 0])).logit).toBeCloseTo(share - Math.log(1 - Math.exp(share)), 5);
    expect((await splatOf(Number.POSITIVE_INFINITY, 1e-4, [0, 0, 0])).logit).toBeCloseTo(
      -Math.log(1.5e-8),
      3,
    );
    // Squares beyond float64.
    const double = { scales: [-500, -500, -500], type: 'double' };
    const tiny = await splatOf(0, 1e-300, double.scales, double.type);
    expect(tiny.logScales[0]).toBeCloseTo(-500, 3);
    const huge = await splatOf(0, 1e300, [20, 20, 20], 'double');
    expect(huge.logScales[0]).toBeCloseTo(300 * Math.LN10, 2);
    expect(huge.logit).toBeCloseTo(3 * (20 - 300 * Math.LN10) - Math.LN2, 1);
  });

  test('a filter that is not finite leaves its splat out; one of a list is refused', async () => {
    for (const filter of [Number.NaN, Number.POSITIVE_INFINITY]) {
      const [bad, good] = [filtered(1, filter), filtered(1, 0.1)];
      const properties = bad.properties.map(({ name, type, values }, i) => ({
        name,
        type,
        values: [...values, ...good.properties[i].values],
      }));
      const { fileIndices, dropped } = await readFixture({ name: 'vertex', count: 2, properties });
      expect([...fileIndices]).toEqual([1]);
      expect(dropped).toEqual({ 'non-finite-scale': 1 });
    }
    const list = withProperty(filtered(1, 0), 'filter_3D', { countType: 'uchar', values: [[1]] });
    expect((await fileErrorOf(readFixture(list))).message).toContain('filter_3D is a list');
  });

  test('splats of 2DGS have it along two axes', async () => {
    const { properties, ...element } = filtered(0, 1, [0, 0, 0]);
    const { logScales, opacityLogits } = await readFixture({
      ...element,
      properties: properties.filter(({ name }) => name !== 'scale_2'),
    });
    expect(logScales[0]).toBeCloseTo(Math.log(2) / 2, 6);
    expect(logScales[2]).toBe(-20);
    expect(1 / (1 + Math.exp(-opacityLogits[0]))).toBeCloseTo(0.25, 6);
  });
});

test('anchors of Scaffold-GS are named, which are no splats yet', async () => {
  const { properties, ...element } = splatElement(2);
  const anchors = properties.filter(({ name }) => !name.startsWith('f_dc'));
  anchors.push({ name: 'f_anchor_feat_0', type: 'float', values: [0, 0] });
  const error = await fileErrorOf(readFixture({ ...element, properties: anchors }));
  expect(error).toMatchObject({ code: 'not-splats', message: expect.stringContaining('Scaffold-GS') });
});

describe('rows that are not finite', () => {
  const bad = [Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  const reasonOf = (name: string) => {
    if (/^[xyz]$/.test(name)) return 'non-finite-position';
    if (name.startsWith('f_')) return 'non-finite-color';
    return { scale: 'non-finite-scale', rot: 'non-finite-rotation', opacity: 'non-finite-opacity' }[
      name.split('_')[0]
    ];
  };
  for (const name of splatNames(1)) {
    /**
     * @fault Files: rows that are not finite
     * @consequence left out, and counted by reason
     */
    test(`${name} is left out and counted`, async () => {
      const splats = splatElement(5, 1, (property, row) =>
        property === name && row >= 1 && row <= 3 ? bad[row - 1] : distinctValue(property, row),
      );
      for (const format of FORMATS) {
        const { fileIndices, dropped, logScales, opacityLogits } = await read(
          spelled(plyBytes({ format, elements: [splats] })),
        );
        if (name.startsWith('scale')) {
          expect([...fileIndices]).toEqual([0, 3, 4]);
          expect(logScales[3 + Number(name.at(-1))]).toBe(Number.NEGATIVE_INFINITY);
          expect(dropped).toEqual({ 'non-finite-scale': 2 });
        } else if (name === 'opacity') {
          expect([...fileIndices]).toEqual([0, 2, 3, 4]);
          expect([...opacityLogits.subarray(1, 3)]).toEqual([
            Number.POSITIVE_INFINITY,
            Number.NEGATIVE_INFINITY,
          ]);
          expect(dropped).toEqual({ 'non-finite-opacity': 1 });
        } else {
          expect([...fileIndices]).toEqual([0, 4]);
          expect(dropped).toEqual({ [reasonOf(name) as string]: 3 });
        }
      }
    });
  }

  /** In text as C prints it. */
  function spelled(bytes: Uint8Array): Uint8Array {
    const text = new TextDecoder('latin1').decode(bytes);
    return text.includes('ascii')
      ? textFile(text.replaceAll('Infinity', 'inf').replaceAll('NaN', '-nan(ind)'))
      : bytes;
  }

  test('a double beyond float32 counts as not finite', async () => {
    const splats = splatElement(2);
    const wide = withProperty(splats, 'x', { type: 'double', values: [1, 1e39] });
    expect((await readFixture(wide)).dropped).toEqual({ 'non-finite-position': 1 });
  });

  /**
   * @fault Files: log scales of −∞ in a PLY, or in the bounds of a compressed one
   * @consequence flat splats, on the CPU and by rows on the GPU alike, in every format that is written
   */
  test('doubles and halves of log scales: −∞ is flat, also what float32 takes for that', async () => {
    const double = { type: 'double', values: [-1e39, Number.NEGATIVE_INFINITY, 1e39] };
    const wide = await readFixture(withProperty(splatElement(3), 'scale_1', double));
    expect([wide.logScales[1], wide.logScales[4]]).toEqual(Array(2).fill(Number.NEGATIVE_INFINITY));
    expect(wide.dropped).toEqual({ 'non-finite-scale': 1 });
    const values = [0xfc00, toHalfBits(-2)];
    const properties = splatElement(2).properties.map((property) => ({
      ...property,
      type: 'ushort',
      values: property.name === 'scale_2' ? values : [toHalfBits(-2), toHalfBits(-2)],
    }));
    const halves = await readFixture({ name: 'vertex', count: 2, properties });
    expect([...halves.logScales]).toEqual([-2, -2, Number.NEGATIVE_INFINITY, -2, -2, -2]);
  });

  test('all left out: empty, with the counts', async () => {
    const splats = splatElement(3, 0, (name, row) => (name === (row < 2 ? 'x' : 'rot_1') ? Number.NaN : 1));
    const error = await fileErrorOf(readFixture(splats));
    expect(error.code).toBe('empty');
    expect(error.message).toContain('2 non-finite-position, 1 non-finite-rotation');
  });
});

describe('origin', () => {
  const at = (type: string, xs: number[]) =>
    readFixture(
      withProperty(
        splatElement(xs.length, 0, (name) => (name === 'x' ? 0 : 1e-3)),
        'x',
        { type, values: xs },
      ),
    );

  test.each([
    { name: 'around zero', xs: [-1, 2], origin: 0 },
    { name: 'up to four half-extents away', xs: [3, 5], origin: 0 },
    { name: 'beyond', xs: [3.1, 5.1], origin: 4 },
    { name: 'one splat', xs: [7], origin: 7 },
  ])('$name', async ({ xs, origin }) => {
    const set = await at('float', xs);
    expect(set.origin[0]).toBe(origin);
    // float32 files keep every bit, whatever the origin.
    expect(xs.map((_, i) => set.positions[3 * i] + origin)).toEqual(xs.map(Math.fround));
  });

  test('doubles far out keep millimetres', async () => {
    const xs = [6.4e6, 6.4e6 + 0.001, 6.4e6 + 0.002];
    const set = await at('double', xs);
    const found = xs.map((_, i) => set.positions[3 * i] + set.origin[0]);
    found.forEach((x, i) => {
      expect(Math.abs(x - xs[i])).toBeLessThan(1e-9);
    });
  });

  test('32-bit integers keep their last unit', async () => {
    const xs = [2_000_000_001, 2_000_000_003, -2_000_000_000 + 4_000_000_000];
    const set = await at('uint', xs);
    expect(xs.map((_, i) => set.positions[3 * i] + set.origin[0])).toEqual(xs);
  });
});

/**
 * @fault Files: two megabytes of digits and a letter
 * @consequence `SplatFileError` at once
 */
describe('refuses', () => {
  const header = (...lines: string[]) => textFile(`${['ply', ...lines].join('\n')}\n`);
  const splats = splatElement(4);
  const without = (...names: string[]) => ({
    ...splats,
    properties: splats.properties.filter(({ name }) => !names.includes(name)),
  });
  const whole = plyBytes({ format: LE, elements: [splats] });
  const face: FixtureElement = {
    name: 'face',
    count: 1,
    properties: [{ name: 'vertex_indices', type: 'int', countType: 'uchar', values: [[0, 1, 2]] }],
  };
  const asciiWith = (line: string) => {
    const text = new TextDecoder().decode(plyBytes({ format: 'ascii', elements: [splatElement(2)] }));
    const lines = text.split('\n');
    lines[lines.length - 2] = line;
    return textFile(lines.join('\n'));
  };
  const cases: { name: string; bytes: Uint8Array; code: string; says: RegExp; place?: object }[] = [
    {
      name: 'no end_header',
      bytes: header('format ascii 1.0'),
      code: 'bad-header',
      says: /no end_header before the file ends/,
    },
    {
      name: 'endless header',
      bytes: textFile(`ply\n${'comment x\n'.repeat(200_000)}`),
      code: 'bad-header',
      says: /first 1048576 bytes/,
    },
    {
      name: 'endless line',
      bytes: textFile(`ply\ncomment ${'x'.repeat(2 << 20)}`),
      code: 'bad-header',
      says: /first 1048576 bytes/,
    },
    {
      name: 'as many elements as a header can hold',
      bytes: header(
        'format ascii 1.0',
        ...Array.from({ length: 60_000 }, (_, i) => `element ${i.toString(36)} 1`),
        'end_header',
      ),
      code: 'not-splats',
      says: /no element vertex; elements found: 0, .*7, and 59992 others/,
    },
    { name: 'no format', bytes: header('end_header'), code: 'bad-header', says: /no "format" line/ },
    {
      name: 'other format',
      bytes: header('format binary_middle_endian 1.0', 'end_header'),
      code: 'bad-header',
      says: /binary_middle_endian/,
      place: { line: 2 },
    },
    {
      name: 'other version',
      bytes: header('format ascii 2.0', 'end_header'),
      code: 'bad-header',
      says: /2\.0/,
    },
    {
      name: 'second format',
      bytes: header('format ascii 1.0', 'format ascii 1.0', 'end_header'),
      code: 'bad-header',
      says: /second/,
      place: { line: 3, byte: 21 },
    },
    {
      name: 'unknown line',
      bytes: header('format ascii 1.0', 'hello world', 'end_header'),
      code: 'bad-header',
      says: /hello world/,
      place: { line: 3 },
    },
    {
      name: 'negative count',
      bytes: header('format ascii 1.0', 'element vertex -1', 'end_header'),
      code: 'bad-header',
      says: /"-1" is no count/,
    },
    {
      name: 'count beyond doubles',
      bytes: header('format ascii 1.0', 'element vertex 99999999999999999999', 'end_header'),
      code: 'bad-header',
      says: /no count/,
    },
    {
      name: 'element twice',
      bytes: plyBytes({ format: LE, elements: [face, face] }),
      code: 'bad-header',
      says: /face is declared twice/,
    },
    {
      name: 'property without element',
      bytes: header('format ascii 1.0', 'property float x', 'end_header'),
      code: 'bad-header',
      says: /before any "element"/,
    },
    {
      name: 'short property line',
      bytes: header('format ascii 1.0', 'element vertex 1', 'property float', 'end_header'),
      code: 'bad-header',
      says: /expected "property/,
    },
    {
      name: 'unknown type',
      bytes: header('format ascii 1.0', 'element vertex 1', 'property quarter x', 'end_header'),
      code: 'bad-property',
      says: /"quarter" is no type/,
      place: { line: 4, property: 'x' },
    },
    {
      name: 'list length in floats',
      bytes: header('format ascii 1.0', 'element face 1', 'property list float int i', 'end_header'),
      code: 'bad-property',
      says: /length cannot be float/,
    },
    {
      name: 'position as a list',
      bytes: plyBytes({
        format: LE,
        elements: [withProperty(splats, 'x', { countType: 'uchar', values: [[1], [1], [1], [1]] })],
      }),
      code: 'bad-property',
      says: /x is a list/,
    },
    {
      name: 'property twice',
      bytes: plyBytes({
        format: LE,
        elements: [{ ...splats, properties: [...splats.properties, splats.properties[0]] }],
      }),
      code: 'bad-property',
      says: /x is declared twice/,
    },
    {
      name: 'odd number of f_rest',
      bytes: plyBytes({
        format: LE,
        elements: [{ ...splats, properties: splatElement(4, 3).properties.slice(0, 14 + 44) }],
      }),
      code: 'bad-property',
      says: /44 f_rest/,
    },
    {
      name: 'a gap in f_rest',
      bytes: plyBytes({
        format: LE,
        elements: [withProperty(splatElement(4, 1), 'f_rest_4', { name: 'f_rest_40' })],
      }),
      code: 'bad-property',
      says: /f_rest_4 is missing/,
    },
    {
      name: 'point cloud',
      bytes: plyBytes({ format: LE, elements: [{ ...splats, properties: splats.properties.slice(0, 3) }] }),
      code: 'not-splats',
      says: /plain point cloud.*lack scale_0, scale_1.*f_dc_2/,
    },
    {
      name: 'mesh',
      bytes: plyBytes({
        format: LE,
        elements: [{ ...splats, properties: splats.properties.slice(0, 3) }, face],
      }),
      code: 'not-splats',
      says: /mesh \(1 face rows\)/,
    },
    ...['opacity', 'rot_3', 'scale_1', 'f_dc_0', 'y'].map((name) => ({
      name: `no ${name}`,
      bytes: plyBytes({ format: LE, elements: [without(name)] }),
      code: 'not-splats',
      says: new RegExp(`no complete splats.*lack ${name}\\.`),
    })),
    {
      name: 'no vertex element',
      bytes: plyBytes({ format: LE, elements: [face] }),
      code: 'not-splats',
      says: /no element vertex; elements found: face/,
    },
    {
      name: 'compressed, which nothing in the first bytes tells',
      bytes: header(
        `format ${LE} 1.0`,
        `comment ${'x'.repeat(SNIFF_BYTES)}`,
        'element chunk 1',
        'property float min_x',
        'element vertex 1',
        'property uint packed_position',
        'end_header',
      ),
      code: 'unknown-format',
      says: /compressed PLY/,
    },
    {
      name: 'zero splats',
      bytes: plyBytes({ format: LE, elements: [splatElement(0)] }),
      code: 'empty',
      says: /0 splats/,
    },
    {
      name: 'cut off',
      bytes: whole.subarray(0, whole.length - 1),
      code: 'truncated',
      says: /4 splats need at least 224 bytes after the header, the file has 223/,
    },
    {
      name: 'a bad word',
      bytes: asciiWith('1 2 3 4 5 0x6 7 8 9 10 11 12 13 14'),
      code: 'bad-value',
      says: /"0x6" is no number/,
      place: { line: 20, row: 1, property: 'f_dc_2' },
    },
    {
      name: 'two megabytes of digits that end in a letter',
      bytes: asciiWith(`${'1'.repeat(2 << 20)}x 2 3 4 5 6 7 8 9 10 11 12 13 14`),
      code: 'bad-value',
      says: /"1{60}…" is no number/,
    },
    {
      name: 'a comma',
      bytes: asciiWith('1,5 2 3 4 5 6 7 8 9 10 11 12 13 14'),
      code: 'bad-value',
      says: /"1,5"/,
      place: { property: 'x' },
    },
    {
      name: 'a short line',
      bytes: asciiWith('1 2 3'),
      code: 'bad-value',
      says: /ends before f_dc_0/,
      place: { row: 1 },
    },
    {
      name: 'a long line',
      bytes: asciiWith('1 2 3 4 5 6 7 8 9 10 11 12 13 14 15'),
      code: 'bad-value',
      says: /15 values where 14/,
    },
    {
      name: 'too few lines',
      bytes: asciiWith(' '.repeat(60)),
      code: 'truncated',
      says: /before its 2 splats/,
      place: { row: 1 },
    },
  ];
  test.each(cases)('$name', async ({ bytes, code, says, place }) => {
    const error = await fileErrorOf(readSplats(bytes, { name: 'scene.ply' }));
    expect(error.message).toMatch(says);
    expect(error.message.startsWith('scene.ply: ')).toBe(true);
    expect(error.code).toBe(code);
    expect(error.file).toBe('scene.ply');
    if (place) expect(error.place).toMatchObject(place);
  });

  test('a cut-off stream of unknown size names the row and the byte', async () => {
    const error = await fileErrorOf(readSplats(chunked(whole.subarray(0, whole.length - 57), [100])));
    expect(error.code).toBe('truncated');
    const expectedBytes = whole.length;
    expect(error.place).toEqual({ element: 'vertex', row: 2, byte: expectedBytes - 57, expectedBytes });
  });

  test('a list of negative length', async () => {
    const negative: FixtureElement = {
      name: 'face',
      count: 1,
      properties: [{ name: 'i', type: 'char', values: [-1] }],
    };
    const text = new TextDecoder('latin1').decode(plyBytes({ format: LE, elements: [negative, splats] }));
    const bytes = Uint8Array.from(text.replace('property char i', 'property list char int i'), (c) =>
      c.charCodeAt(0),
    );
    expect((await fileErrorOf(read(bytes))).message).toMatch(/list of -1 items/);
  });

  test.each([4_000_000_000, 2 ** 40])(
    'a header that promises %i splats allocates nothing for them',
    async (count) => {
      const text = new TextDecoder('latin1').decode(whole).replace('vertex 4', `vertex ${count}`);
      const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
      const before = process.memoryUsage().arrayBuffers;
      expect((await fileErrorOf(read(bytes))).code).toBe('truncated');
      const code = count > 2 ** 32 ? 'too-large' : 'truncated';
      const unlimited = { maxSplats: Number.POSITIVE_INFINITY };
      expect((await fileErrorOf(readSplats(chunked(bytes, [64]), unlimited))).code).toBe(code);
      expect((await fileErrorOf(readSplats(chunked(bytes, [64])))).code).toBe('too-large');
      expect(process.memoryUsage().arrayBuffers - before).toBeLessThan(64e6);
    },
  );
});

/**
 * @fault Files: a header line of megabytes arrives in small chunks
 * @consequence no byte is searched twice
 */
test('no byte of a long line is searched twice', async () => {
  const text = new TextDecoder().decode(plyBytes({ format: 'ascii', elements: [splatElement(1)] }));
  const bytes = textFile(`${text.trimEnd()}${' '.repeat(1 << 18)}\n`);
  const searching = vi.spyOn(Object.getPrototypeOf(Uint8Array.prototype), 'lastIndexOf');
  expect((await readSplats(chunked(bytes, [1024]))).count).toBe(1);
  const searched = (searching.mock.contexts as Uint8Array[]).reduce((sum, { length }) => sum + length, 0);
  searching.mockRestore();
  expect(searched).toBeGreaterThan(1 << 18);
  expect(searched).toBeLessThanOrEqual(bytes.length);
});

test('a page gets turns while a large buffer is read', async () => {
  const rows = 200_000;
  const text = new TextDecoder('latin1').decode(plyBytes({ format: LE, elements: [splatElement(1, 3)] }));
  const start = text.indexOf('end_header\n') + 11;
  const large = Uint8Array.from(text.slice(0, start).replace('vertex 1', `vertex ${rows}`), (c) =>
    c.charCodeAt(0),
  );
  const bytes = new Uint8Array(large.length + rows * 236);
  bytes.set(large);
  let turns = 0;
  const timer = setInterval(() => turns++, 0);
  await read(bytes, 'u8');
  clearInterval(timer);
  expect(turns).toBeGreaterThan(0);
});

describe('properties', () => {
  const float = fc.float({
    noNaN: true,
    noDefaultInfinity: true,
    min: Math.fround(-1e6),
    max: Math.fround(1e6),
  });
  const small = fc.integer({ min: 0, max: 127 });

  /** A file of splats with anything else in any order, and the splats to read from it. */
  const fixtures = fc
    .record({
      format: fc.constantFrom(...FORMATS),
      degree: fc.constantFrom<ShDegree>(0, 1, 2, 3),
      count: fc.integer({ min: 1, max: 6 }),
      lineEnd: fc.constantFrom('\n', '\r\n', '\r'),
    })
    .chain(({ format, degree, count, lineEnd }) => {
      const column = fc.oneof(
        fc.record({
          type: fc.constantFrom('float', 'float32', 'double', 'float64'),
          values: fc.array(float, { minLength: count, maxLength: count }),
        }),
        fc.record({
          type: fc.constantFrom(
            'char',
            'uchar',
            'short',
            'ushort',
            'int',
            'uint',
            'int8',
            'uint8',
            'int16',
            'uint16',
            'int32',
            'uint32',
          ),
          values: fc.array(small, { minLength: count, maxLength: count }),
        }),
      );
      const list = fc.record({
        type: fc.constantFrom('uchar', 'double'),
        countType: fc.constantFrom('uchar', 'int'),
        values: fc.array(fc.array(small, { maxLength: 3 }), { minLength: count, maxLength: count }),
      });
      const named = splatNames(degree).map((name) => column.map((values) => ({ name, ...values })));
      const extras = fc.array(fc.oneof(column, list), { maxLength: 3 });
      const properties = fc
        .tuple(fc.tuple(...named), extras)
        .map(([core, more]): FixtureProperty[] => [
          ...core,
          ...more.map((extra, i) => ({ name: `extra_${i}`, ...extra })),
        ])
        .chain((all) => fc.shuffledSubarray(all, { minLength: all.length }));
      return properties.map(
        (all): Fixture => ({ format, lineEnd, elements: [{ name: 'vertex', count, properties: all }] }),
      );
    });

  test('any order, type and byte order reads back', () =>
    fc.assert(
      fc.asyncProperty(fixtures, async (fixture) => {
        const set = await read(plyBytes(fixture));
        const { count, properties } = fixture.elements[0];
        expect(set.count).toBe(count);
        for (const { name, values } of properties.filter(({ name }) => !name.startsWith('extra'))) {
          for (let i = 0; i < count; i++) {
            const expected = values[i] as number;
            const tolerance = /^[xyz]$/.test(name) ? 4e-7 * Math.max(...set.positions.map(Math.abs)) : 0;
            const found = valueIn(set, name, i);
            expect(Math.abs(found - (tolerance ? expected : Math.fround(expected)))).toBeLessThanOrEqual(
              tolerance,
            );
          }
        }
      }),
      { numRuns: 100 },
    ));

  test('written files read back to the bit', () =>
    fc.assert(
      fc.asyncProperty(
        fc.constantFrom<ShDegree>(0, 1, 2, 3),
        fc.integer({ min: 1, max: 8 }),
        fc.constantFrom(0, 10, 1e5),
        fc.infiniteStream(float),
        async (degree, count, offset, stream) => {
          const next = () => stream.next().value as number;
          const splats = splatElement(count, degree, (name) =>
            CORE_NAMES.indexOf(name) < 3 ? offset + (next() % 1) : next(),
          );
          const set = await readFixture(splats);
          expect(await read(encodePly(set))).toEqual(set);
        },
      ),
      { numRuns: 100 },
    ));
});

describe('moving scenes (Spacetime Gaussians)', () => {
  const set = movingSplats({ count: 40, seed: 12, shDegree: 1 });
  const MOTION_NAMES = [
    'trbf_center',
    'trbf_scale',
    ...Array.from({ length: 9 }, (_, i) => `motion_${i}`),
    ...Array.from({ length: 4 }, (_, i) => `omega_${i}`),
  ];
  /** A text file with the properties of one opaque splat at 1, 2, 3 and some of a motion. */
  const motionFile = (values: Readonly<Record<string, number>>) => {
    const all = {
      ...Object.fromEntries(splatNames(0).map((name) => [name, 1])),
      x: 1,
      y: 2,
      z: 3,
      ...values,
    };
    const properties = Object.keys(all).map((name) => `property float ${name}\n`);
    return textFile(
      `ply\nformat ascii 1.0\nelement vertex 1\n${properties.join('')}end_header\n${Object.values(all).join(' ')}\n`,
    );
  };

  /**
   * @fault Files: a PLY of Spacetime Gaussians, which moves
   * @consequence drawn at the time that is asked for, and `fileFacts.notes` says that it moves
   */
  test('are read as they were written, bit for bit, and say so', async () => {
    const bytes = encodePly(set);
    for (const name of MOTION_NAMES) expect(new TextDecoder('latin1').decode(bytes)).toContain(` ${name}\n`);
    const back = await read(bytes);
    expect(back.motion).toEqual(set.motion);
    expect(back.positions).toEqual(set.positions);
    expect(back.fileFacts!.notes).toEqual([expect.stringMatching(/moving scene/)]);
    expect((await read(encodePly({ ...set, motion: undefined }))).motion).toBeUndefined();
  });

  test('may have fewer powers of time, no turn and no time', async () => {
    const motion = (values: Readonly<Record<string, number>>) =>
      read(motionFile(values)).then((each) => Array.from(each.motion!, (value) => Number(value.toFixed(3))));
    expect(await motion({ trbf_center: 0.25, trbf_scale: -1 })).toEqual([0.25, -1, ...new Array(13).fill(0)]);
    expect(await motion({ motion_0: 1, motion_1: 2, motion_2: 3 })).toEqual([
      ...[0, 80, 1, 2, 3],
      ...new Array(10).fill(0),
    ]);
    expect(await motion({ omega_3: 4, omega_2: 3, omega_1: 2, omega_0: 1 })).toEqual([
      ...[0, 80, ...new Array(9).fill(0)],
      ...[1, 2, 3, 4],
    ]);
  });

  test('with part of a group of properties are refused', async () => {
    const error = await fileErrorOf(
      read(motionFile({ trbf_center: 0, trbf_scale: 0, motion_0: 1, motion_2: 1 })),
    );
    expect(error).toMatchObject({ code: 'bad-property', place: { property: 'motion_1' } });
    expect(error.message).toMatch(/motion_0, motion_2 without motion_1/);
  });

  /** A moving file with f_dc from 0 to 1, as the lite trainer saves them. */
  const RGB = [0, 1, 0.25];
  const NAMES = [...CORE_NAMES, ...MOTION_NAMES];
  const colorFile = ({
    names = NAMES,
    comments = [],
    type = 'float',
    format = LE,
  }: {
    readonly names?: readonly string[];
    readonly comments?: readonly string[];
    readonly type?: string;
    readonly format?: (typeof FORMATS)[number];
  } = {}) => {
    const properties = names.map((name): FixtureProperty => {
      const value = name.startsWith('f_dc') ? (RGB[Number(name.slice(5))] ?? 0.5) : 1;
      return { name, type, values: [value] };
    });
    return plyBytes({ format, comments, elements: [{ name: 'vertex', count: 1, properties }] });
  };
  const colorsOf = ({ colorDc }: SplatSet<Harmonics>) => Array.from(colorDc, (value) => colorOf(value));
  const expectColors = async (file: Uint8Array, rgb: readonly number[]) => {
    const set = await read(file);
    for (const [k, color] of colorsOf(set).entries()) expect(color).toBeCloseTo(rgb[k], 6);
    return set.fileFacts!.notes;
  };

  /**
   * @fault Files: a moving PLY of the lite trainer of Spacetime Gaussians, whose `f_dc` are red, green and blue
   * @consequence drawn in its colours, and `fileFacts.notes` says how `f_dc` were read
   */
  test.each([
    ['a binary', {}],
    ['a text', { format: 'ascii' }],
    ['a big-endian', { format: 'binary_big_endian' }],
    ['a double', { type: 'double' }],
    ['a commented', { comments: ['comment Generated by something', 'comment scene 12'] }],
    ['a turnless', { names: [...CORE_NAMES, 'trbf_center', 'trbf_scale'] }],
    ['a filtered', { names: [...NAMES, 'filter_3D'] }],
  ] as const)('of the lite trainer have red, green and blue: %s file', async (_, given) => {
    expect(await expectColors(colorFile(given), RGB)).toContainEqual(
      expect.stringMatching(/f_dc are taken for red, green/),
    );
  });

  const HARMONIC_RGB = RGB.map(colorOf);
  test.each([
    ['f_rest', { names: [...NAMES, ...Array.from({ length: 9 }, (_, i) => `f_rest_${i}`)] }],
    ['a comment with sh_degree', { comments: ['comment cfg_args Namespace(sh_degree=0, eval=True)'] }],
    ['a comment that says so', { comments: ['comment colours: Spherical Harmonics'] }],
    ['no trbf', { names: [...CORE_NAMES, 'motion_0', 'motion_1', 'motion_2'] }],
    ['no motion', { names: CORE_NAMES }],
  ] as const)('with %s have harmonics', async (_, given) => {
    const notes = await expectColors(colorFile(given), HARMONIC_RGB);
    expect(String(notes)).not.toMatch(/red, green/);
  });

  test('keep the colours of the lite trainer when they are written and read again', async () => {
    const first = await read(colorFile());
    const again = await read(encodePly(first));
    expect(again.colorDc).toEqual(first.colorDc);
    expect(String(again.fileFacts!.notes)).not.toMatch(/red, green/);
    const frozen = await read(encodePly(splatsAt(first, 1)));
    expect(frozen.colorDc).toEqual(first.colorDc);
    const zipped = await readSplats(new File([zipFiles({ 'a.ply': colorFile() })], 'a.zip'));
    expect(zipped.colorDc).toEqual(first.colorDc);
  });

  /**
   * @fault Files: a PLY of the full model of Spacetime Gaussians, whose colours a network makes
   * @consequence `SplatFileError` 'not-splats', which says to train or export the lite model
   */
  test.each([[['f_dc_3']], [['f_t_0', 'f_t_1', 'f_t_2']], [['f_dc_3', 'f_dc_4', 'f_dc_5', 'f_t_0']]])(
    'whose colours a network makes are refused: %s',
    async (more) => {
      const error = await fileErrorOf(read(colorFile({ names: [...NAMES, ...more] })));
      expect(error).toMatchObject({ code: 'not-splats', place: { property: more[0] } });
      expect(error.message).toMatch(/network in another file.*lite model/);
    },
  );

  test('are not written in formats that hold no motion', async () => {
    await expect(writeSplats(set, 'spz')).rejects.toThrow(
      /These splats move, and .spz holds only splats that stand still. Freeze them at a time, by splatsAt/,
    );
    expect((await read(await writeSplats(set, 'ply'))).motion).toEqual(set.motion);
  });

  test('are written in pieces', async () => {
    const source = new File([encodePly(set)], 'a.ply');
    const facts = new PieceFacts();
    const options = { shPrecision: 'f32' } as const;
    await readSplatPieces(source, options, async (piece) => facts.add(piece));
    const parts: Uint8Array<ArrayBuffer>[] = [];
    const pieces = { facts, read: (onPiece: never) => readSplatPieces(source, options, onPiece) };
    await writeSplatPieces(pieces, 'ply', {}, async (bytes) => void parts.push(bytes));
    expect((await read(new Uint8Array(await new Blob(parts).arrayBuffer()))).motion).toEqual(set.motion);
    await expect(writeSplatPieces(pieces, 'spz', {}, async () => {})).rejects.toThrow(/These splats move/);
  });
});
