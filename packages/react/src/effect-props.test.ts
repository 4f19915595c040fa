import { applyProps } from '@react-three/fiber';
import { InvalidArgumentError } from '@websplatter/core';
import { EFFECTS, SplatSelection, tint } from '@websplatter/core/effects';
import { Box3, Camera, Color, Plane, Scene, Sphere, Vector3 } from 'three';
import { expect, it, vi } from 'vitest';
import {
  type Clamp,
  checkEffectProps,
  type EffectProps,
  isSameUses,
  isSameValue,
  takeEffectProps,
  usesOfOptions,
} from './effect-props.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';

const asGiven: Clamp = (_property, value) => value;

const drawn = (object: SplatCloudObject) => object.effectsAt(0, new Scene(), new Camera())!;

/** The effects that an object with these props is drawn with. */
const usesOf = (props: EffectProps) => drawn(Object.assign(new SplatCloudObject(), props));

const optionsOf = (props: EffectProps) =>
  Object.fromEntries(usesOf(props).map(({ effect, options }) => [effect.name, options]));

it('turns each prop, in three’s terms, into its effect', () => {
  const selection = new SplatSelection();
  const own = tint([1, 0.5, 0]);
  expect(usesOf({})).toEqual([]);
  expect(usesOf({ effects: [] })).toEqual([]);
  // Overrides the file's own setting.
  expect(usesOf({ antialias: false })).toMatchObject([{ options: false, reason: null }]);
  expect(usesOf({ effects: [own] })).toEqual([own]);
  const sphere = { shape: 'sphere', mode: 'hide', radius: 1, softEdge: 0.1 } as const;
  const props: EffectProps = {
    tint: 'white',
    brightness: 2,
    antialias: true,
    volumes: [
      new Box3(new Vector3(0, 0, 0), new Vector3(2, 2, 2)),
      new Sphere(new Vector3(1, 0, 0), 3),
      new Plane(new Vector3(0, 1, 0), -1),
      sphere,
    ],
    reveal: { from: 'camera', radius: 3 },
    highlight: { selection, color: 'black', strength: 0.5 },
  };
  expect(optionsOf(props)).toEqual({
    tint: [1, 1, 1],
    brightness: 2,
    antialias: true,
    volumes: [
      { shape: 'box', mode: 'keep', center: [1, 1, 1], size: [2, 2, 2] },
      { shape: 'sphere', mode: 'keep', center: [1, 0, 0], radius: 3 },
      { shape: 'plane', mode: 'keep', point: [0, 1, 0], normal: [0, 1, 0] },
      sphere,
    ],
    reveal: { from: 'camera', radius: 3, softEdge: 0 },
    highlight: { selection, color: [0, 0, 0], strength: 0.5 },
  });
  expect(usesOf({ volumes: [] })[0].reason).toBeNull();
});

it('takes colours as three does, or as the numbers that effects take', () => {
  for (const tint of ['red', 0xff0000, new Color('red'), [1, 0, 0]] as const)
    expect(optionsOf({ tint })).toEqual({ tint: [1, 0, 0] });
  expect(optionsOf({ tint: [2, 1, 0.5] })).toEqual({ tint: [2, 1, 0.5] });
});

it('reads a Color when it is set, and lets no one write into it', () => {
  const object = new SplatCloudObject();
  const red = new Color('red');
  object.tint = red;
  expect(object.tint).toEqual([1, 0, 0]);
  applyProps(object as never, { tint: new Color('blue') });
  expect(red.getHexString()).toBe('ff0000');
  expect(object.tint).toEqual([0, 0, 1]);
});

it('gives copies of an object its effects', () => {
  const props = { tint: 'red', brightness: 2, reveal: { from: 'camera', radius: 1 } } as const;
  const copy = Object.assign(new SplatCloudObject(), props).clone();
  expect(copy).toMatchObject(props);
});

/** Numbers beyond their range, by prop. */
const OVERSHOT: readonly (readonly [string, EffectProps, EffectProps])[] = [
  ['brightness', { brightness: -0.01 }, { brightness: 0 }],
  ['brightness', { brightness: 2 ** 21 }, { brightness: 2 ** 20 }],
  ['tint', { tint: [1, -0.1, 0] }, { tint: [1, 0, 0] }],
  ['reveal', { reveal: { from: [0, -1, 0], radius: -1 } }, { reveal: { from: [0, -1, 0], radius: 0 } }],
  [
    'reveal',
    { reveal: { from: 'camera', radius: 1, softEdge: -1 } },
    { reveal: { from: 'camera', radius: 1, softEdge: 0 } },
  ],
  [
    'volumes',
    { volumes: [{ shape: 'sphere', mode: 'hide', center: [0, -1, 0], radius: -0.1 }] },
    { volumes: [{ shape: 'sphere', mode: 'hide', center: [0, -1, 0], radius: 0 }] },
  ],
  [
    'volumes',
    { volumes: [{ shape: 'box', mode: 'keep', center: [0, -1, 0], size: [-1, 1, 1] }] },
    { volumes: [{ shape: 'box', mode: 'keep', center: [0, -1, 0], size: [0, 1, 1] }] },
  ],
  [
    'volumes',
    { volumes: [{ shape: 'capsule', mode: 'fade', opacity: 1.5, height: -1, softEdge: -1 }] },
    { volumes: [{ shape: 'capsule', mode: 'fade', opacity: 1, height: 0, softEdge: 0 }] },
  ],
  ...[
    [1.2, 1],
    [-0.1, 0],
  ].map(([overshot, nearest]) => {
    const selection = new SplatSelection();
    const highlight = (strength: number) => ({ highlight: { selection, color: 'red', strength } }) as const;
    return ['highlight', highlight(overshot), highlight(nearest)] as const;
  }),
];

/**
 * @fault Arguments: an opacity or an effect option is out of range
 * @consequence clamped, with one warning
 */
it.each(OVERSHOT)('draws %s as the nearest in its range, and says so once: %o', (name, overshot, nearest) => {
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
  checkEffectProps(overshot);
  expect(warn, 'where props are checked').not.toHaveBeenCalled();
  const object = Object.assign(new SplatCloudObject(), overshot);
  for (let frame = 0; frame < 2; frame++) expect(isSameUses(drawn(object), usesOf(nearest))).toBe(true);
  expect(warn.mock.calls).toEqual([[expect.stringMatching(new RegExp(`^${name} of a cloud`))]]);
  // What the engine itself takes and refuses.
  expect(() => usesOfOptions(nearest, asGiven)).not.toThrow();
  if (name !== 'reveal') expect(() => usesOfOptions(overshot, asGiven)).toThrow(InvalidArgumentError);
  warn.mockRestore();
});

it('refuses numbers that are none', () => {
  const { NaN: nan } = Number;
  for (const props of [
    { opacity: nan },
    { opacity: Number.POSITIVE_INFINITY },
    { fade: nan },
    { relight: nan },
    { fade: Number.NEGATIVE_INFINITY },
    { brightness: nan },
    { tint: [1, nan, 0] },
    { reveal: { from: 'camera', radius: nan } },
    { volumes: [{ shape: 'sphere', mode: 'hide', radius: nan }] },
  ])
    expect(() => checkEffectProps(props as EffectProps)).toThrow(InvalidArgumentError);
});

it('takes a prop of every effect but those that are the object’s own, and leaves other props', () => {
  const others = { opacity: 0.5, fog: false, position: [0, 0, 1] };
  const props: Record<string, unknown> = Object.fromEntries(Object.keys(EFFECTS).map((name) => [name, {}]));
  Object.assign(props, { tint: 'red', effects: [] }, others);
  const names = Object.keys(EFFECTS).filter((name) => !(name in others));
  expect(takeEffectProps(props)).toEqual({
    ...Object.fromEntries(names.map((name) => [name, {}])),
    tint: [1, 0, 0],
    effects: [],
  });
  expect(props).toEqual(others);
});

it('asks for nothing where a prop is missing, null or false, but for `antialias={false}`', () => {
  const nothing = { tint: null, volumes: false, reveal: undefined, highlight: null, brightness: false };
  expect(usesOf(nothing as unknown as EffectProps)).toEqual([]);
});

it('leaves a reveal over a time to the object', () => {
  const reveal = { from: 'camera', durationMs: 500 } as const;
  expect(usesOfOptions({ reveal } as object, asGiven)).toEqual([]);
  checkEffectProps({ reveal });
  const endless = { from: 'camera', durationMs: Number.POSITIVE_INFINITY } as const;
  expect(() => checkEffectProps({ reveal: endless })).toThrow(InvalidArgumentError);
});

it('recognises equal props that are written out again', () => {
  const selection = new SplatSelection();
  const same = (a: EffectProps, b: EffectProps) =>
    isSameValue(takeEffectProps({ ...a }), takeEffectProps({ ...b }));
  const props = (radius: number): EffectProps => ({
    volumes: [new Sphere(new Vector3(1, 2, 3), radius)],
    highlight: { selection, color: 'red', strength: 1 },
  });
  expect(same(props(1), props(1))).toBe(true);
  expect(same(props(1), props(2))).toBe(false);
  expect(same({ brightness: 2 }, {})).toBe(false);
  expect(same({ brightness: 2 }, { antialias: true })).toBe(false);
  const other = { ...props(1).highlight!, selection: new SplatSelection() };
  expect(same(props(1), { ...props(1), highlight: other })).toBe(false);
  expect(isSameUses([tint([1, 0, 0])], [tint([1, 0, 0])])).toBe(true);
  expect(isSameUses([tint([1, 0, 0])], [tint([1, 1, 0])])).toBe(false);
  expect(isSameUses([tint([1, 0, 0])])).toBe(false);
});

it.each<[unknown, unknown, boolean]>([
  [1, 1, true],
  [Number.NaN, Number.NaN, true],
  [null, {}, false],
  [[1, [2]], [1, [2]], true],
  [[1, 2], [1], false],
  [{ a: 1, b: undefined }, { a: 1 }, false],
  [{ a: undefined }, { b: undefined }, false],
  [[], {}, false],
  [new Vector3(), new Vector3(), false],
])('compares %o and %o', (a, b, expected) => {
  expect(isSameValue(a, b)).toBe(expected);
  expect(isSameValue(b, a)).toBe(expected);
});

const HOSTILE: unknown[] = [
  ...[Number.NaN, Number.POSITIVE_INFINITY, -1, 1e39, 10n, true, 'x', Symbol('s'), null, {}, [], [undefined]],
  ...[[Number.NaN, 0, 0], new Map(), () => 3, Object.create(null), Array(3)],
];

/**
 * @fault Arguments: any value for a React effect prop
 * @consequence accepted, or an `InvalidArgumentError` that names the option
 */
it('takes any value of any effect’s prop, or refuses it by the name of the option', () => {
  const good = {
    tint: 'red',
    brightness: 2,
    antialias: true,
    volumes: [new Sphere(new Vector3(), 1), { shape: 'box', mode: 'keep', size: [1, 1, 1] }],
    reveal: { from: 'camera', durationMs: 500, softEdge: 1 },
    highlight: { selection: new SplatSelection(), color: 'red', strength: 1 },
    effects: [],
  };
  expect(usesOfOptions(good as EffectProps, asGiven)).toHaveLength(5);
  let refused = 0;
  const give = (props: object, ...names: string[]) => {
    try {
      checkEffectProps(takeEffectProps({ ...props }));
    } catch (error) {
      expect(error).toBeInstanceOf(InvalidArgumentError);
      // Of `volumes[0].size`, say, the first part.
      const [named] = (error as InvalidArgumentError).argument.split(/[.[]/);
      expect(names).toContain(named);
      refused++;
    }
  };
  for (const value of HOSTILE) {
    for (const [name, options] of Object.entries(good)) {
      const optionNames = name === 'tint' ? ['color'] : Array.isArray(options) ? [] : Object.keys(options);
      give({ ...good, [name]: value }, name, ...optionNames);
      if (typeof options !== 'object') continue;
      for (const option of optionNames) give({ ...good, [name]: { ...options, [option]: value } }, option);
    }
    give({ volumes: [value] }, 'volumes');
    give({ effects: [value] }, 'effects');
  }
  expect(refused).toBeGreaterThan(100);
});
