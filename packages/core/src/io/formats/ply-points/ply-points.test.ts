import { describe, expect, test } from 'vitest';
import { SplatFileError } from '../../../data/errors.ts';
import {
  distinctValue,
  type Fixture,
  type FixtureElement,
  type FixtureProperty,
  plyBytes,
  splatElement,
} from '../../../testing/ply-fixture.ts';
import { outcomeOf } from '../../../testing/read-damaged.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { detectFormat } from '../detect.ts';

const SH_C0 = 0.28209479177387814;
const FORMATS = ['ascii', 'binary_little_endian', 'binary_big_endian'] as const;

const column = (name: string, type: string, values: readonly number[]): FixtureProperty => ({
  name,
  type,
  values,
});
const colors = (type: string, max: number) => [
  column('red', type, [0, max]),
  column('green', type, [max, 0]),
  column('blue', type, [max, max]),
];
/** Two points, √(3² + 4² + 12²) = 13 apart. */
const positions = [
  column('x', 'float', [1, 4]),
  column('y', 'double', [1, 5]),
  column('z', 'float', [-12, 0]),
];

const points = (...more: readonly FixtureProperty[]): FixtureElement => ({
  name: 'vertex',
  count: 2,
  properties: [...positions, column('nx', 'float', [0, 1]), ...more],
});
const encode = (element: FixtureElement, format: Fixture['format'] = 'binary_little_endian') =>
  plyBytes({ format, elements: [element] });
const read = (bytes: Uint8Array) => readSplats(bytes, { name: 'scan.ply', shPrecision: 'f32' });

describe('points', () => {
  test.each(
    FORMATS.flatMap((format) =>
      (
        [
          ['uchar', 255],
          ['uint8', 255],
          ['ushort', 65535],
          ['float', 1],
          ['double', 1],
        ] as const
      ).map(([type, max]) => ({ format, type, max })),
    ),
  )('$format with colours as $type are round splats', async ({ format, type, max }) => {
    const set = await read(encode(points(...colors(type, max)), format));
    expect(set).toMatchObject({ count: 2, dropped: {}, harmonics: { degree: 0 } });
    expect(set.fileFacts).toEqual({
      format: 'ply',
      variant: format,
      notes: [expect.stringMatching(/points are shown as round splats/)],
    });
    const [black, white] = [-0.5, 0.5].map((value) => Math.fround(value / SH_C0));
    expect([...set.colorDc]).toEqual([black, white, white, white, black, white]);
    expect([...set.opacityLogits]).toEqual([Infinity, Infinity]);
    expect([...set.rotations]).toEqual([1, 0, 0, 0, 1, 0, 0, 0]);
    expect([...set.logScales]).toEqual(Array(6).fill(Math.fround(Math.log(13 / Math.SQRT2 / 2))));
    expect(set.positions[0] + set.origin[0]).toBe(1);
  });

  test('may have an alpha, which is their opacity', async () => {
    const alpha = column('alpha', 'uchar', [255, 51]);
    const set = await read(encode(points(...colors('uchar', 255), alpha)));
    expect([...set.opacityLogits]).toEqual([Infinity, Math.fround(Math.log(0.2 / 0.8))]);
    const beyond = await read(encode(points(...colors('uchar', 255), column('alpha', 'float', [2, -1]))));
    expect([...beyond.opacityLogits]).toEqual([Infinity, -Infinity]);
  });

  test('all in one place have a size, too', async () => {
    const one: FixtureElement = {
      name: 'vertex',
      count: 1,
      properties: points(...colors('uchar', 255)).properties.map((each) => ({ ...each, values: [7] })),
    };
    expect([...(await read(encode(one))).logScales]).toEqual(Array(3).fill(Math.fround(Math.log(0.5))));
  });

  test('that are not finite are dropped', async () => {
    const bad = { ...points(...colors('float', 1)) };
    const properties = bad.properties.map((each) =>
      each.name === 'x' ? { ...each, values: [Number.NaN, 4] } : each,
    );
    const set = await read(encode({ ...bad, properties }));
    expect(set).toMatchObject({ count: 1, dropped: { 'non-finite-position': 1 } });
  });
});

describe('splats with colours', () => {
  const splats = splatElement(2);
  const withColors = {
    ...splats,
    properties: [
      ...splats.properties.filter(({ name }) => !name.startsWith('f_dc')),
      ...colors('uchar', 255),
    ],
  };

  test('keep all else', async () => {
    const set = await read(encode(withColors));
    expect(set).toMatchObject({ count: 2, harmonics: { degree: 0 } });
    expect(set.fileFacts?.notes).toBeUndefined();
    expect(set.colorDc[0]).toBe(Math.fround(-0.5 / SH_C0));
    for (let i = 0; i < 2; i++) {
      expect(set.opacityLogits[i]).toBe(distinctValue('opacity', i));
      for (let axis = 0; axis < 3; axis++)
        expect(set.logScales[3 * i + axis]).toBe(distinctValue(`scale_${axis}`, i));
      for (let part = 0; part < 4; part++)
        expect(set.rotations[4 * i + part]).toBe(distinctValue(`rot_${part}`, i));
    }
  });

  test('are told from ordinary PLY by their header', () => {
    const of = (bytes: Uint8Array) => detectFormat(bytes.subarray(0, 512), 'a', ['a.ply']).name;
    expect(of(encode(withColors))).toBe('ply-points');
    expect(of(encode({ ...splats, properties: [...splats.properties, ...colors('uchar', 255)] }))).toBe(
      'ply',
    );
    expect(of(encode(points()))).toBe('ply');
  });
});

describe('refuses', () => {
  const face: FixtureElement = {
    name: 'face',
    count: 1,
    properties: [{ name: 'vertex_indices', type: 'int', countType: 'uchar', values: [[0, 1, 0]] }],
  };
  const format = 'binary_little_endian';
  test.each([
    [
      'a mesh',
      plyBytes({ format, elements: [points(...colors('uchar', 255)), face] }),
      /mesh \(1 face rows\)/,
    ],
    ['colours in signed numbers', encode(points(...colors('int', 255))), /plain point cloud/],
    ['red only', encode(points(colors('uchar', 255)[0])), /plain point cloud/],
    [
      'points with rotations only',
      encode(points(...colors('uchar', 255), column('rot_0', 'float', [1, 1]))),
      /plain point cloud|no complete/,
    ],
    ['no positions', encode({ ...points(), properties: colors('uchar', 255) }), /lack x, y, z/],
  ] as const)('%s', async (_, bytes, says) => {
    const error = await read(bytes).then(
      () => undefined,
      (reason) => reason,
    );
    expect(error).toBeInstanceOf(SplatFileError);
    expect(error.code).toBe('not-splats');
    expect(error.message).toMatch(says);
  });

  test('every truncation', async () => {
    const bytes = encode(points(...colors('uchar', 255)));
    for (let length = 0; length < bytes.length; length++)
      expect(await outcomeOf(bytes.slice(0, length), 'a.ply')).toBeInstanceOf(SplatFileError);
  });
});
