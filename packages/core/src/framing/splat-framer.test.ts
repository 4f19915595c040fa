import { describe, expect, test } from 'vitest';
import { filterSplats } from '../data/editing/crop-splats.ts';
import { limitDegree } from '../data/editing/limit-degree.ts';
import { type Quaternion, rotationMatrixOf } from '../data/editing/quaternion.ts';
import { transformSplats } from '../data/editing/transform-splats.ts';
import { transform3 } from '../data/math/mat4.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { splatsOf } from '../testing/random-splats.ts';
import { stillLife } from '../testing/still-life.ts';
import type { SceneFraming } from './scene-framing.ts';
import { SplatFramer } from './splat-framer.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';

/** Radius of the still life's sky, about 0. */
const SKY = 110;
const DEGREE = Math.PI / 180;

const TURNS: readonly (readonly [string, Quaternion])[] = [
  ['y up, as it is', [1, 0, 0, 0]],
  ['y down, as in most captures', [0, 1, 0, 0]],
  ['z up', [1, 1, 0, 0]],
  ['up along no axis', [0.9, 0.2, 0.3, -0.5]],
];

type SceneName = Parameters<typeof stillLife>[0] & string;
type Framed = { readonly framer: SplatFramer; readonly framing: SceneFraming };

const sets = new Map<SceneName, Promise<SplatSet<Harmonics>>>();
const framings = new Map<string, Promise<Framed>>();

function framed(set: SplatSet<Harmonics>, modelMatrix?: readonly number[]): Framed {
  const framer = new SplatFramer();
  framer.add(set, modelMatrix);
  return { framer, framing: framer.frame()! };
}

/** A turned scene as it is framed without options: once for all tests. */
function framedScene(name: SceneName, rotation: Quaternion): Promise<Framed> {
  // Framers drop harmonics; turning them would take longer than framing.
  const set = sets.get(name) ?? stillLife(name).then((still) => limitDegree(still, 0));
  sets.set(name, set);
  const key = `${name} ${rotation}`;
  const found = framings.get(key) ?? set.then((still) => framed(transformSplats(still, { rotation })));
  framings.set(key, found);
  return found;
}

describe.each([
  ['still-life', isFull ? TURNS : TURNS.slice(1)],
  ['still-life-small', TURNS],
] as const)('%s is upright, within its sky, with', (name, turns) => {
  test.each(turns)('%s', { tags: 'deeper' }, async (_, rotation) => {
    const { up, position, target } = (await framedScene(name, rotation)).framing;
    const expected = transform3([...rotationMatrixOf(rotation)], [0, 1, 0]);
    const cosine = up[0] * expected[0] + up[1] * expected[1] + up[2] * expected[2];
    expect(Math.acos(Math.min(1, cosine)) / DEGREE).toBeLessThan(5);
    expect(Math.hypot(...position)).toBeLessThan(SKY / 10);
    expect(Math.hypot(...target)).toBeLessThan(1);
  });
});

test.each(TURNS.slice(0, 2))(
  'kind and up are the same for every field of view, %s',
  { tags: 'deeper' },
  async (_, rotation) => {
    // 75° is the default of react-three-fiber's cameras.
    const windows = [
      [30, 1.6],
      [75, 0.5],
    ] as const;
    const few = rotation === TURNS[0][1] ? 'still-life-small' : 'still-life';
    for (const name of isFull ? (['still-life', 'still-life-small'] as const) : ([few] as const)) {
      const { framer, framing } = await framedScene(name, rotation);
      const { kind, up } = framing;
      for (const [fovYDegrees, aspect] of windows)
        expect(framer.frame({ fovYDegrees, aspect }), `${name}, ${fovYDegrees}°`).toMatchObject({ kind, up });
    }
  },
);

test('a model matrix moves the camera with the splats', async () => {
  const set = await stillLife();
  const { framing: still } = await framedScene('still-life-small', [1, 0, 0, 0]);
  // Ten times as large, and moved.
  const { framing: moved } = framed(set, [10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 7, 8, 9, 1]);
  const expected = still.position.map((value, axis) => expect.closeTo(10 * value + 7 + axis, 3));
  expect(moved.position).toEqual(expected);
  expect(moved.radius).toBeCloseTo(10 * still.radius, 4);
});

test('how splats are divided into pieces changes nothing, however many they are', async () => {
  const set = await stillLife();
  const cut = (from: number, to: number) => filterSplats(set, (index) => index >= from && index < to);
  const [whole, pieces] = [new SplatFramer(), new SplatFramer()];
  // More than are kept, so that some pieces have no splat that is.
  for (let i = 0; i < 15; i++) {
    whole.add(set);
    for (const [from, to] of [
      [0, 1],
      [1, 2],
      [2, 3334],
      [3334, 10_000],
    ])
      pieces.add(cut(from, to));
  }
  const framing = whole.frame()!;
  expect(pieces.frame()).toEqual(framing);
  const { framing: single } = await framedScene('still-life-small', [1, 0, 0, 0]);
  expect(framing.kind).toBe(single.kind);
  expect(framing.up).toEqual(single.up);
});

test('there is no camera without splats that can be seen', () => {
  const framer = new SplatFramer();
  expect(framer.frame()).toBeNull();
  framer.add(splatsOf([{ opacityLogit: Number.NEGATIVE_INFINITY }]));
  expect(framer.frame()).toBeNull();
});

test('arguments that are none are refused by name', () => {
  const framer = new SplatFramer();
  expect(() => framer.add(null as never)).toThrow('set');
  expect(() => framer.add(splatsOf([{}]), [1])).toThrow('modelMatrix');
  expect(() => framer.frame({ aspect: 0 })).toThrow('aspect');
  expect(() => framer.frame({ up: [0, 0, 0] })).toThrow('up');
  expect(() => framer.frame({ kind: 'park' as never })).toThrow('kind');
});
