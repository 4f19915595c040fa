import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../../data/errors.ts';
import { identity4, type Vec3 } from '../../../data/math/mat4.ts';
import { reference } from './clip.reference.ts';
import { type ClipOptions, type ClipVolume, clip } from './clip.ts';

const PLACE = { modelMatrix: identity4(), origin: [0, 0, 0], viewMatrix: identity4() } as const;
const BOX: ClipVolume = { shape: 'box', center: [1, 0, 0], size: [2, 4, 6] };
const SPHERE: ClipVolume = { shape: 'sphere', center: [0, 0, 0], radius: 2 };
const PLANE: ClipVolume = { shape: 'plane', point: [0, 1, 0], normal: [0, 5, 0] };

function opacityAt(position: Vec3, options: ClipOptions): number {
  const splat = { position, opacity: 1, row: 0, rotation: [1, 0, 0, 0], logScales: [0, 0, 0] } as const;
  return reference(options, PLACE).changeSplat!(splat, 0).opacity;
}

describe('clip', () => {
  test('keeps the inside of a volume, or the outside', () => {
    const cases: readonly (readonly [ClipVolume, Vec3, Vec3])[] = [
      [BOX, [1.9, 1.9, 2.9], [2.1, 0, 0]],
      [BOX, [0.1, -1.9, -2.9], [1, 0, 3.1]],
      // A quarter turn about z: four wide and two high.
      [{ ...BOX, rotation: [0, 0, 1, 1] }, [2.9, 0.9, 0], [1, 1.1, 0]],
      [SPHERE, [1.1, 1.1, 1.1], [1.2, 1.2, 1.2]],
      [PLANE, [9, 1.1, -9], [0, 0.9, 0]],
    ];
    for (const [volume, inside, outside] of cases) {
      expect(opacityAt(inside, { volumes: [volume] })).toBe(1);
      expect(opacityAt(outside, { volumes: [volume] })).toBe(0);
      expect(opacityAt(inside, { volumes: [{ ...volume, keep: 'outside' }] })).toBe(0);
      expect(opacityAt(outside, { volumes: [{ ...volume, keep: 'outside' }] })).toBe(1);
    }
  });

  test('fades in along a soft edge, on the kept side only', () => {
    const opacities = (volume: ClipVolume) =>
      [1.9, 2, 2.25, 2.5, 3, 3.1].map((y) => opacityAt([0, y, 0], { volumes: [volume], softEdge: 1 }));
    expect(opacities({ ...PLANE, point: [0, 2, 0] })).toEqual([0, 0, 0.15625, 0.5, 1, 1]);
    expect(opacities({ ...SPHERE, keep: 'outside' })).toEqual([0, 0, 0.15625, 0.5, 1, 1]);
  });

  test('hides splats that any of several volumes hides; the nearest surface decides how much', () => {
    const volumes = [SPHERE, PLANE];
    expect(opacityAt([0, 1.5, 0], { volumes })).toBe(1);
    expect(opacityAt([0, 0.5, 0], { volumes })).toBe(0);
    expect(opacityAt([0, 2.5, 0], { volumes })).toBe(0);
    expect(opacityAt([0, 1.25, 0], { volumes, softEdge: 0.5 })).toBe(0.5);
  });

  test('multiplies large coordinates in float64', () => {
    const far: Vec3 = [6.4e6, -6.4e6, 6.4e6];
    const volumes: ClipVolume[] = [{ shape: 'sphere', center: [far[0] + 0.25, far[1], far[2]], radius: 1 }];
    const { volume0 } = clip({ volumes }).valuesAt({ ...PLACE, origin: far })!;
    expect((volume0 as number[]).slice(0, 4)).toEqual([1, 0, 0, -0.25]);
  });

  test('gives as many values as its struct takes, whatever the volumes', () => {
    const { effect } = clip({ volumes: [BOX] });
    for (const volumes of [[BOX], [PLANE, SPHERE], Array<ClipVolume>(8).fill(SPHERE)]) {
      const values = clip({ volumes }).valuesAt(PLACE)!;
      expect(() => effect.parameters!.write(new ArrayBuffer(effect.parameters!.bytes), values)).not.toThrow();
      expect(values.volumeCount).toBe(volumes.length);
    }
  });

  test('has a reason that names the volumes', () => {
    expect(clip({ volumes: [PLANE] }).reason).toBe('a plane cuts it off');
    expect(clip({ volumes: [PLANE, BOX] }).reason).toBe('2 volumes cut it off');
  });

  const box = (change: object) => [{ ...BOX, ...change }];
  const refused: Readonly<Record<string, readonly [object, RegExp]>> = {
    'no volumes': [{ volumes: [] }, /^There are 0 volumes; clip takes 1 to 8/],
    'more than eight': [{ volumes: Array(9).fill(BOX) }, /^There are 9 volumes/],
    'none given': [{}, /^There are no volumes/],
    'another shape': [{ volumes: box({ shape: 'cone' }) }, /volumes\[0\]\.shape is cone; it must be "box", /],
    'another side': [{ volumes: box({ keep: 'left' }) }, /volumes\[0\]\.keep is left; .*"outside"/],
    'a box without centre': [{ volumes: box({ center: undefined }) }, /volumes\[0\]\.center is undefined/],
    'a centre nowhere': [{ volumes: box({ center: [0, Number.NaN, 0] }) }, /center is \[0, NaN, 0\]/],
    'a negative size': [
      { volumes: [SPHERE, ...box({ size: [1, -1, 1] })] },
      /volumes\[1\]\.size is \[1, -1, 1\]/,
    ],
    'an infinite size': [{ volumes: box({ size: [1, Number.POSITIVE_INFINITY, 1] }) }, /3 finite numbers/],
    'no rotation': [
      { volumes: box({ rotation: [0, 0, 0, 0] }) },
      /rotation is \[0, 0, 0, 0\]; .*not all of them 0/,
    ],
    'a rotation of three': [{ volumes: box({ rotation: [0, 0, 1] }) }, /4 finite numbers/],
    'a negative radius': [
      { volumes: [{ ...SPHERE, radius: -2 }] },
      /radius is -2; .* world units, 0 or more/,
    ],
    'a radius beyond float32': [{ volumes: [{ ...SPHERE, radius: 1e39 }] }, /radius is 1e\+39/],
    'a normal without direction': [{ volumes: [{ ...PLANE, normal: [0, 0, 0] }] }, /normal is \[0, 0, 0\]/],
    'a point nowhere': [{ volumes: [{ ...PLANE, point: [0, 0, Number.NEGATIVE_INFINITY] }] }, /point is/],
    'a negative edge': [{ volumes: [BOX], softEdge: -0.1 }, /^softEdge is -0.1; /],
    'an edge of no number': [{ volumes: [BOX], softEdge: Number.NaN }, /^softEdge is NaN; /],
  };
  for (const [what, [options, message]] of Object.entries(refused))
    test(`rejects ${what}`, () => {
      expect(() => clip(options as ClipOptions)).toThrow(InvalidArgumentError);
      expect(() => clip(options as ClipOptions)).toThrow(message);
    });

  test('takes directions of any length', () => {
    for (const length of [1e-30, 1, 1e30]) {
      const plane = { ...PLANE, normal: [0, length, 0] } as const;
      const turned = { ...BOX, rotation: [0, 0, length, length] } as const;
      const { volume0, volume1 } = clip({ volumes: [plane, turned] }).valuesAt(PLACE)!;
      expect((volume0 as number[]).slice(0, 4)).toEqual([0, 1, 0, -1]);
      for (const [i, value] of [0, 1, 0, 0, -1, 0, 0, 1].entries())
        expect((volume1 as number[])[i]).toBeCloseTo(value, 12);
    }
  });
});
