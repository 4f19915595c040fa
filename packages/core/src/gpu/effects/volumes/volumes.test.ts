import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../../data/errors.ts';
import { identity4, type Vec3 } from '../../../data/math/mat4.ts';
import { type CullSplatsVariant, cullSplats } from '../../../stages/cull/cull.ts';
import { seededRandom } from '../../../testing/seeded-random.ts';
import { linkInput } from '../../shaders/link-shader.ts';
import { linkModules } from '../../shaders/shader-linker.ts';
import { effectSetOf, packParameters } from '../effect-set.ts';
import { boundingRadius, frameOf } from './volume-frame.ts';
import { reference } from './volumes.reference.ts';
import { type Volume, type VolumeShape, volumeClearance, volumes } from './volumes.ts';

const PLACE = {
  modelMatrix: identity4(),
  origin: [0, 0, 0],
  viewMatrix: identity4(),
  projection: { isOrthographic: false, focalPx: [1, 1] },
} as const;
const BOX = { shape: 'box', center: [1, 0, 0], size: [2, 4, 6] } as const;
const SPHERE = { shape: 'sphere', radius: 2 } as const;
const PLANE = { shape: 'plane', point: [0, 1, 0], normal: [0, 5, 0] } as const;
const CAPSULE = { shape: 'capsule', radius: 0.5, height: 2 } as const;
const ELLIPSOID = { shape: 'ellipsoid', size: [2, 4, 6] } as const;
/** Scales by 2, 3 and 0.5, then turns by a quarter about z, then moves. */
const MATRIX = [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 0.5, 0, 5, 6, 7, 1];

const splatAt = (position: Vec3) =>
  ({ position, opacity: 1, row: 0, rotation: [1, 0, 0, 0], logScales: [0, 0, 0] }) as const;

function changedAt(position: Vec3, list: readonly Volume[]) {
  return reference(list, PLACE).changeSplat!(splatAt(position), 0);
}

function colorAt(position: Vec3, list: readonly Volume[]) {
  return reference(list, PLACE).changeColor!([1, 1, 1], splatAt(position), 0, position);
}

describe('volumes', () => {
  test('hide the inside, or keep it', () => {
    const cases: readonly (readonly [VolumeShape & { readonly matrix?: number[] }, Vec3, Vec3])[] = [
      [BOX, [1.9, 1.9, 2.9], [2.1, 0, 0]],
      [BOX, [0.1, -1.9, -2.9], [1, 0, 3.1]],
      // A quarter turn about z: four wide and two high.
      [{ ...BOX, rotation: [0, 0, 1, 1] }, [2.9, 0.9, 0], [1, 1.1, 0]],
      [{ shape: 'box', matrix: MATRIX }, [6.4, 6.9, 7.2], [6.6, 6, 7]],
      [SPHERE, [1.1, 1.1, 1.1], [1.2, 1.2, 1.2]],
      [{ shape: 'sphere', matrix: MATRIX }, [7.9, 6, 7], [6, 6, 7.6]],
      [PLANE, [9, 1.1, -9], [0, 0.9, 0]],
      // Its normal z is scaled, which leaves it where it is.
      [{ shape: 'plane', matrix: MATRIX }, [0, 0, 7.1], [0, 0, 6.9]],
      [CAPSULE, [0.3, 1.3, 0], [0.4, 1.4, 0]],
      [{ ...CAPSULE, rotation: [0, 0, 1, 1] }, [-1.4, 0, 0], [0, 0.6, 0]],
      [ELLIPSOID, [0.1, 0.1, 2.9], [0.9, 1, 0]],
    ];
    for (const [shape, inside, outside] of cases)
      for (const [mode, invert, within] of [
        ['hide', false, 0],
        ['keep', false, 1],
        ['hide', true, 1],
        ['keep', true, 0],
      ] as const) {
        const volume = { ...shape, mode, invert };
        expect(changedAt(inside, [volume]).opacity).toBe(within);
        expect(changedAt(outside, [volume]).opacity).toBe(1 - within);
        expect(volumeClearance(volume)(inside) > 0).toBe(within === 1);
        expect(volumeClearance(volume)(outside) > 0).toBe(within === 0);
      }
  });

  test('act fully up to their surface, and fade out beyond it', () => {
    const opacities = (volume: Volume) =>
      [1.9, 2, 2.25, 2.5, 3, 3.1].map((y) => changedAt([0, y, 0], [volume]).opacity);
    const plane = { ...PLANE, point: [0, 2, 0], softEdge: 1 } as const;
    expect(opacities({ ...plane, mode: 'keep' })).toEqual([0, 0, 0.15625, 0.5, 1, 1]);
    expect(opacities({ ...SPHERE, softEdge: 1, mode: 'hide' })).toEqual([0, 0, 0.15625, 0.5, 1, 1]);
    expect(opacities({ ...SPHERE, softEdge: 1, mode: 'fade', opacity: 0.2 })[3]).toBeCloseTo(0.6, 12);
  });

  test('fade, displace and tint', () => {
    expect(changedAt([0, 1, 0], [{ ...SPHERE, mode: 'fade', opacity: 0.25 }]).opacity).toBe(0.25);
    const displaced = { ...SPHERE, mode: 'displace', offset: [1, 2, 3] } as const;
    expect(changedAt([0, 1, 0], [displaced]).position).toEqual([1, 3, 3]);
    // In the volume's own space.
    const turned = { shape: 'sphere', mode: 'displace', offset: [1, 2, 3], matrix: MATRIX } as const;
    expect(changedAt([5, 6, 7], [turned]).position).toEqual([-1, 8, 8.5]);
    expect(colorAt([0, 1, 0], [{ ...SPHERE, mode: 'tint', tint: [2, 1, 0] }])).toEqual([2, 1, 0]);
  });

  test('act in their order, tints last', () => {
    const away = { ...SPHERE, mode: 'displace', offset: [10, 0, 0] } as const;
    const hole = { ...SPHERE, mode: 'hide' } as const;
    expect(changedAt([0, 0, 0], [away, hole]).opacity).toBe(1);
    expect(changedAt([0, 0, 0], [hole, away]).opacity).toBe(0);
    const lamp = { ...SPHERE, mode: 'tint', tint: [2, 2, 2] } as const;
    const list = [lamp, away];
    expect(colorAt(changedAt([0, 0, 0], list).position, list)).toEqual([1, 1, 1]);
    // Both keep: what is in both stays.
    const kept = [
      { ...SPHERE, mode: 'keep' },
      { ...PLANE, mode: 'keep' },
    ] as const;
    expect(changedAt([0, 1.5, 0], kept).opacity).toBe(1);
    expect(changedAt([0, 0.5, 0], kept).opacity).toBe(0);
    expect(changedAt([0, 2.5, 0], kept).opacity).toBe(0);
  });

  test('that are flattened or have no size contain nothing', () => {
    const flat = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1];
    const empty: VolumeShape[] = [
      { ...BOX, size: [2, 2, 0] },
      { ...SPHERE, radius: 0 },
      { ...CAPSULE, radius: 0 },
      { ...ELLIPSOID, size: [0, 1, 1] },
    ];
    const shapes: (VolumeShape & { readonly matrix?: number[] })[] = [
      ...empty,
      ...[BOX, SPHERE, PLANE, CAPSULE, ELLIPSOID].map((shape) => ({ ...shape, matrix: flat })),
    ];
    for (const shape of shapes)
      for (const [mode, opacity] of [
        ['hide', 1],
        ['keep', 0],
      ] as const) {
        expect(changedAt([1, 1, 0], [{ ...shape, mode, softEdge: 1 }]).opacity).toBe(opacity);
        const { list } = volumes([{ ...shape, mode }]).valuesAt(PLACE)! as { list: number[] };
        expect(list.every((value) => Number.isFinite(Math.fround(value)))).toBe(true);
      }
  });

  test('multiply large coordinates in float64', () => {
    const far: Vec3 = [6.4e6, -6.4e6, 6.4e6];
    const sphere = {
      shape: 'sphere',
      mode: 'keep',
      center: [far[0] + 0.25, far[1], far[2]],
      radius: 1,
    } as const;
    const { list } = volumes([sphere]).valuesAt({ ...PLACE, origin: far })! as { list: number[] };
    expect(list.slice(8, 12)).toEqual([1, 0, 0, -0.25]);
  });

  test('do nothing outside of their bounding spheres', () => {
    const random = seededRandom(5);
    const between = (low: number, high: number) => low + (high - low) * random();
    const vector = (most: number): Vec3 => [between(-most, most), between(-most, most), between(-most, most)];
    for (let i = 0; i < 120; i++) {
      const matrix = [...vector(1), 0, ...vector(1), 0, ...vector(1), 0, ...vector(1), 1];
      const size: Vec3 = [between(0.05, 2), between(0.05, 2), between(0.05, 2)];
      const shape = ([{ shape: 'box', size }, { shape: 'ellipsoid', size }, CAPSULE, SPHERE] as const)[i % 4];
      const softEdge = i % 3 === 0 ? 0 : between(0, 1);
      const volume = { ...shape, mode: 'hide', matrix, softEdge } as const;
      const frame = frameOf(volume)!;
      const radius = boundingRadius(frame, softEdge);
      const clearance = volumeClearance(volume);
      let least = Number.POSITIVE_INFINITY;
      for (let j = 0; j < 40; j++) {
        const direction = vector(1);
        const length = (1.0001 * radius) / Math.hypot(...direction);
        const point = direction.map((value, axis) => frame.center[axis] + value * length);
        least = Math.min(least, clearance(point as unknown as Vec3) - softEdge);
      }
      expect(least).toBeGreaterThanOrEqual(0);
    }
  });

  const TINT = { ...SPHERE, mode: 'tint', tint: [1, 0, 0] } as const;
  const HIDE = { ...SPHERE, mode: 'hide' } as const;
  const CULL: CullSplatsVariant = {
    isOrthographic: false,
    geometryPrecision: 'packed',
    extent: 'opacity',
    culling: 'bounding-box',
  };

  test('put only the functions and the room that they need into shaders', () => {
    expect(volumes([]).reason).toBeNull();
    expect(Object.keys(volumes([TINT]).hooks)).toEqual(['color']);
    expect(Object.keys(volumes([HIDE]).hooks)).toEqual(['splat']);
    expect(Object.keys(volumes([HIDE, TINT]).hooks)).toEqual(['splat', 'color']);
    const textOf = (list: readonly Volume[]) =>
      linkModules(linkInput(cullSplats({ ...CULL, effects: effectSetOf([volumes(list)]) })));
    expect(textOf([TINT])).toBe(linkModules(linkInput(cullSplats(CULL))));
    for (const [count, vectors] of [
      [1, 8],
      [2, 16],
      // With a grid from three on.
      [3, 64],
      [5, 128],
      [64, 1024],
      [256, 2048],
    ]) {
      const list = Array<Volume>(count).fill(HIDE);
      expect(textOf(list)).toContain(`list: array<vec4f, ${vectors}>`);
      expect(effectSetOf([volumes(list)]).parameterBytes).toBe(16 * vectors);
    }
    // Shaders are shared by lists of similar lengths.
    const sets = [3, 4].map((count) => effectSetOf([volumes(Array<Volume>(count).fill(HIDE))]));
    expect(sets[0]).toBe(sets[1]);
  });

  test('lie in their order in the parameters, tints last', () => {
    const use = volumes([TINT, HIDE]);
    const packed = packParameters(effectSetOf([use]), [[{ values: use.valuesAt(PLACE) }]]);
    const floats = new Float32Array(packed.buffer);
    expect(floats.length).toBe(4 * 16);
    expect([...floats.slice(0, 2)]).toEqual([1, 2]);
    expect([...floats.slice(28, 32)]).toEqual([0, 0, 0, 0]);
    expect([...floats.slice(56, 60)]).toEqual([1, 0, 0, 0]);
  });

  test('have a reason that names the volume', () => {
    expect(volumes([{ ...PLANE, mode: 'keep' }]).reason).toBe('a plane hides the splats outside of it');
    expect(volumes([{ ...ELLIPSOID, mode: 'tint', tint: [1, 0, 0] }]).reason).toBe(
      'an ellipsoid tints splats',
    );
    expect(volumes([HIDE, TINT]).reason).toBe('2 volumes change it');
  });

  const box = (change: object) => [{ ...BOX, mode: 'keep', ...change }];
  const refused: Readonly<Record<string, readonly [unknown, RegExp]>> = {
    'no list': [{}, /^volumes is .*a list/],
    'none given': [undefined, /^volumes is undefined/],
    'more than 256': [Array(257).fill(HIDE), /^There are 257 volumes/],
    'another shape': [box({ shape: 'cone' }), /volumes\[0\]\.shape is cone; it must be "box", /],
    'another mode': [box({ mode: 'left' }), /volumes\[0\]\.mode is left; .*"displace"/],
    'a centre nowhere': [box({ center: [0, Number.NaN, 0] }), /center is \[0, NaN, 0\]/],
    'a negative size': [[HIDE, ...box({ size: [1, -1, 1] })], /volumes\[1\]\.size is \[1, -1, 1\]/],
    'an infinite size': [box({ size: [1, Number.POSITIVE_INFINITY, 1] }), /3 finite numbers/],
    'no rotation': [box({ rotation: [0, 0, 0, 0] }), /rotation is \[0, 0, 0, 0\]; .*not all of them 0/],
    'a rotation that is null': [box({ rotation: null }), /rotation is null/],
    'a rotation of three': [box({ rotation: [0, 0, 1] }), /4 finite numbers/],
    'a negative radius': [[{ ...HIDE, radius: -2 }], /radius is -2; .* world units, 0 or more/],
    'a radius beyond float32': [[{ ...HIDE, radius: 1e39 }], /radius is 1e\+39/],
    'a height of no number': [[{ ...CAPSULE, mode: 'hide', height: Number.NaN }], /\[0\]\.height is NaN/],
    'a normal without direction': [[{ ...PLANE, mode: 'hide', normal: [0, 0, 0] }], /normal is \[0, 0, 0\]/],
    'a matrix of nine': [box({ matrix: [1, 0, 0, 0, 1, 0, 0, 0, 1] }), /volumes\[0\]\.matrix is .*16 finite/],
    'a matrix with NaN': [
      box({ matrix: MATRIX.map((value, i) => (i === 5 ? Number.NaN : value)) }),
      /matrix is/,
    ],
    'a negative edge': [box({ softEdge: -0.1 }), /^volumes\[0\]\.softEdge is -0.1; /],
    'an edge of no number': [box({ softEdge: Number.NaN }), /softEdge is NaN; /],
    'an inversion of no boolean': [box({ invert: 1 }), /\[0\]\.invert is 1; it must be true or false/],
    'an opacity above 1': [box({ mode: 'fade', opacity: 1.5 }), /\[0\]\.opacity is 1.5/],
    'no tint': [box({ mode: 'tint' }), /\[0\]\.tint is undefined/],
    'an infinite offset': [
      [HIDE, ...box({ mode: 'displace', offset: [0, Number.POSITIVE_INFINITY, 0] })],
      /volumes\[1\]\.offset is \[0, Infinity, 0\]/,
    ],
  };
  for (const [what, [list, message]] of Object.entries(refused))
    test(`reject ${what}`, () => {
      expect(() => volumes(list as Volume[])).toThrow(InvalidArgumentError);
      expect(() => volumes(list as Volume[])).toThrow(message);
    });

  test('take directions of any length', () => {
    for (const length of [1e-30, 1, 1e30]) {
      const plane = { ...PLANE, mode: 'keep', normal: [0, length, 0] } as const;
      const turned = { ...BOX, mode: 'keep', rotation: [0, 0, length, length] } as const;
      const { list } = volumes([plane, turned]).valuesAt(PLACE)! as { list: number[] };
      expect(list.slice(8, 12)).toEqual([0, 1, 0, -1]);
      for (const [i, value] of [0, 1, 0, 0, -1, 0, 0, 1].entries())
        expect(list[36 + i]).toBeCloseTo(value, 12);
    }
  });
});
