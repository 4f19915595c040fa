import { InvalidArgumentError } from '@websplatter/core';
import { EFFECTS, SplatSelection, tint } from '@websplatter/core/effects';
import { Box3, Plane, Sphere, Vector3 } from 'three';
import { expect, it } from 'vitest';
import {
  type EffectProps,
  isSameUses,
  isSameValue,
  revealAnimationOf,
  takeEffectProps,
  usesOfProps,
} from './effect-props.ts';

const optionsOf = (props: EffectProps) =>
  Object.fromEntries(usesOfProps(props).map(({ effect, options }) => [effect.name, options]));

it('turns each prop, in three’s terms, into its effect', () => {
  const selection = new SplatSelection();
  const own = tint([1, 0.5, 0]);
  expect(usesOfProps({})).toEqual([]);
  expect(usesOfProps({ effects: [] })).toEqual([]);
  // Overrides the file's own setting.
  expect(usesOfProps({ antialias: false })).toMatchObject([{ options: false, reason: null }]);
  expect(usesOfProps({ effects: [own] })).toEqual([own]);
  const sphere = { shape: 'sphere', center: [0, 0, 0], radius: 1, keep: 'outside' } as const;
  const props: EffectProps = {
    tint: 'white',
    brightness: 2,
    antialias: true,
    clip: {
      volumes: [
        new Box3(new Vector3(0, 0, 0), new Vector3(2, 2, 2)),
        new Sphere(new Vector3(1, 0, 0), 3),
        new Plane(new Vector3(0, 1, 0), -1),
        sphere,
      ],
      softEdge: 0.1,
    },
    reveal: { from: 'camera', radius: 3 },
    highlight: { selection, color: 'black', strength: 0.5 },
  };
  expect(optionsOf(props)).toEqual({
    tint: [1, 1, 1],
    brightness: 2,
    antialias: true,
    clip: {
      volumes: [
        { shape: 'box', center: [1, 1, 1], size: [2, 2, 2], keep: 'inside' },
        { shape: 'sphere', center: [1, 0, 0], radius: 3, keep: 'inside' },
        { shape: 'plane', point: [0, 1, 0], normal: [0, 1, 0], keep: 'inside' },
        sphere,
      ],
      softEdge: 0.1,
    },
    reveal: { from: 'camera', radius: 3 },
    highlight: { selection, color: [0, 0, 0], strength: 0.5 },
  });
  expect(() => usesOfProps({ clip: { volumes: [] } })).toThrow(InvalidArgumentError);
});

it('takes a prop of every effect but those that are the object’s own, and leaves other props', () => {
  const others = { opacity: 0.5, fog: false, position: [0, 0, 1] };
  const props: Record<string, unknown> = Object.fromEntries(Object.keys(EFFECTS).map((name) => [name, name]));
  Object.assign(props, { effects: [] }, others);
  const names = Object.keys(EFFECTS).filter((name) => !(name in others));
  expect(takeEffectProps(props)).toEqual({
    ...Object.fromEntries(names.map((name) => [name, name])),
    effects: [],
  });
  expect(props).toEqual(others);
});

it('asks for nothing where a prop is missing, null or false, but for `antialias={false}`', () => {
  const nothing = { tint: null, clip: false, reveal: undefined, highlight: null, brightness: false };
  expect(usesOfProps(nothing as unknown as EffectProps)).toEqual([]);
});

it('leaves a reveal over a time to the object', () => {
  const reveal = { from: 'camera', durationMs: 500 } as const;
  expect(usesOfProps({ reveal })).toEqual([]);
  expect(revealAnimationOf({ reveal })).toBe(reveal);
  expect(revealAnimationOf({ reveal: { from: 'camera', radius: 1 } })).toBeNull();
  expect(revealAnimationOf({})).toBeNull();
  const endless = { from: 'camera', durationMs: Number.POSITIVE_INFINITY } as const;
  expect(() => revealAnimationOf({ reveal: endless })).toThrow(InvalidArgumentError);
});

it('recognises equal props that are written out again', () => {
  const selection = new SplatSelection();
  const same = (a: EffectProps, b: EffectProps) => isSameUses(usesOfProps(a), usesOfProps(b));
  const props = (radius: number): EffectProps => ({
    clip: { volumes: [new Sphere(new Vector3(1, 2, 3), radius)] },
    highlight: { selection, color: 'red', strength: 1 },
  });
  expect(same(props(1), props(1))).toBe(true);
  expect(same(props(1), props(2))).toBe(false);
  expect(same({ brightness: 2 }, {})).toBe(false);
  expect(same({ brightness: 2 }, { antialias: true })).toBe(false);
  const other = { ...props(1).highlight!, selection: new SplatSelection() };
  expect(same(props(1), { ...props(1), highlight: other })).toBe(false);
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

it('takes any value of any effect’s prop, or refuses it by the name of the option', () => {
  const good = {
    tint: 'red',
    brightness: 2,
    antialias: true,
    clip: {
      volumes: [new Sphere(new Vector3(), 1), { shape: 'box', center: [0, 0, 0], size: [1, 1, 1] }],
      softEdge: 1,
    },
    reveal: { from: 'camera', durationMs: 500, softEdge: 1 },
    highlight: { selection: new SplatSelection(), color: 'red', strength: 1 },
    effects: [],
  };
  expect(usesOfProps(good as EffectProps)).toHaveLength(5);
  let refused = 0;
  const give = (props: object, ...names: string[]) => {
    try {
      usesOfProps(props as EffectProps);
      revealAnimationOf(props as EffectProps);
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
      const optionNames = name === 'tint' ? ['color'] : Object.keys(options);
      give({ ...good, [name]: value }, name, ...optionNames);
      if (typeof options !== 'object') continue;
      for (const option of optionNames) give({ ...good, [name]: { ...options, [option]: value } }, option);
    }
    give({ clip: { volumes: [value] } }, 'volumes');
    give({ effects: [value] }, 'effects');
  }
  expect(refused).toBeGreaterThan(100);
});
