import { describe, expect, test } from 'vitest';
import type { Quaternion } from '../data/editing/quaternion.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import { MadeScene, park, room, statue, Y_DOWN, Y_UP, Z_UP } from '../testing/made-scene.ts';
import { frameSample } from './frame-sample.ts';
import type { SplatSample } from './samples.ts';
import type { FramingWishes, SceneFraming } from './scene-framing.ts';

const WISHES: FramingWishes = { aspect: 1.6, fovYDegrees: 50, up: null, usualUp: [0, -1, 0], kind: null };

const framed = (sample: SplatSample, wishes: Partial<FramingWishes> = {}): SceneFraming =>
  frameSample(sample, { ...WISHES, ...wishes })!;

const framings = new Map<string, SceneFraming>();

/** How a scene as it is made is framed: once for all tests. */
function framingOf(make: () => MadeScene, turn: Quaternion = Y_DOWN): SceneFraming {
  const key = `${make.name} ${turn}`;
  const framing = framings.get(key) ?? framed(make().sample(turn));
  framings.set(key, framing);
  return framing;
}

const minus = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const length = (v: Vec3): number => Math.hypot(...v);
const degreesBetween = (a: Vec3, b: Vec3): number =>
  (Math.acos(Math.min(1, dot(a, b) / length(a) / length(b))) * 180) / Math.PI;

/** The part of some splats that is in the picture. */
function partInPicture({ positions, count }: SplatSample, framing: SceneFraming, aspect = 1.6): number {
  const forward = minus(framing.target, framing.position);
  const z = forward.map((value) => value / length(forward)) as unknown as Vec3;
  const across: Vec3 = [
    z[1] * framing.up[2] - z[2] * framing.up[1],
    z[2] * framing.up[0] - z[0] * framing.up[2],
    z[0] * framing.up[1] - z[1] * framing.up[0],
  ];
  const x = across.map((value) => value / length(across)) as unknown as Vec3;
  const y: Vec3 = [x[1] * z[2] - x[2] * z[1], x[2] * z[0] - x[0] * z[2], x[0] * z[1] - x[1] * z[0]];
  const tangent = Math.tan((framing.fovYDegrees * Math.PI) / 360);
  let inside = 0;
  for (let i = 0; i < count; i++) {
    const offset = minus([positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]], framing.position);
    const depth = dot(offset, z);
    const isInside =
      Math.abs(dot(offset, x)) < depth * tangent * aspect && Math.abs(dot(offset, y)) < depth * tangent;
    if (depth > 0 && isInside) inside++;
  }
  return inside / count;
}

describe('up', () => {
  const scenes = { statue, park, room };
  const turns = {
    'y down': [Y_DOWN, [0, -1, 0]],
    'z up': [Z_UP, [0, 0, 1]],
  } as const;
  for (const [scene, make] of Object.entries(scenes))
    for (const [name, [turn, up]] of Object.entries(turns))
      test(`of a ${scene}, ${name}`, () => {
        expect(degreesBetween(framingOf(make, turn).up, up)).toBeLessThan(3);
      });

  test.each(['statue', 'park'] as const)('of a %s with y up, against the convention', (scene) => {
    expect(framingOf(scenes[scene], Y_UP).up).toEqual([0, 1, 0]);
  });

  test('of a tilted place', () => {
    // 25° about x, on top of half a turn.
    const angle = ((180 + 25) * Math.PI) / 360;
    const { up } = framed(park().sample([Math.cos(angle), Math.sin(angle), 0, 0]));
    expect(degreesBetween(up, [0, Math.cos(2 * angle), Math.sin(2 * angle)])).toBeLessThan(3);
  });

  test('a given one is kept, of any length', () => {
    const { up, confidence } = framed(park().sample(), { up: [0, 0, 5] });
    expect(up).toEqual([0, 0, 1]);
    expect(confidence.up).toBe(1);
  });

  test('a table whose top is most of it is not turned over', () => {
    const table = new MadeScene()
      .rectangle(
        [-1.3, 0, -0.9],
        [
          [2.6, 0, 0],
          [0, 0, 1.8],
        ],
        2500,
      )
      .box([-1, 0.7, -0.6], [1, 0.75, 0.6], 3000)
      .box([-0.9, 0, -0.5], [-0.8, 0.7, -0.4], 200)
      .box([0.8, 0, 0.4], [0.9, 0.7, 0.5], 200);
    expect(framed(table.sample()).up).toEqual([0, -1, 0]);
  });

  test('without surfaces it is the usual one', () => {
    const cloud = new MadeScene().cloud([-1, -1, -1], [1, 1, 1], 3000, 0.02).sample();
    const { up, confidence } = framed(cloud);
    expect(up).toEqual([0, -1, 0]);
    expect(framed(cloud, { usualUp: [0, 1, 0] }).up).toEqual([0, 1, 0]);
    expect(confidence.up).toBeLessThan(0.7);
  });
});

describe('kind and camera', () => {
  test('an object is looked at from outside, a little from above, and fills the picture', () => {
    const sample = statue().sample();
    const framing = framingOf(statue);
    expect(framing.kind).toBe('object');
    expect(partInPicture(sample, framing)).toBeGreaterThan(0.98);
    const back = minus(framing.position, framing.target);
    const elevation = 90 - degreesBetween(back, framing.up);
    expect(elevation).toBeGreaterThan(0);
    expect(elevation).toBeLessThan(45);
    const farther = {
      ...framing,
      position: framing.target.map((at, i) => at + 0.75 * back[i]) as unknown as Vec3,
    };
    expect(partInPicture(sample, farther)).toBeLessThan(0.95);
  });

  test('an object is looked at from the side with a picture on it', () => {
    for (const side of [-1, 1]) {
      const sample = new MadeScene().box([-1, 0, -0.1], [1, 1.4, 0.1], 2500).sample();
      for (let i = 0; i < sample.count; i++) {
        const [x, z] = [sample.positions[3 * i], sample.positions[3 * i + 2]];
        // Stripes, which a mean colour of a few of them hides.
        if (z * side > 0.09) sample.colors.fill(Math.floor(20 * x) % 2, 3 * i, 3 * i + 3);
      }
      const { position, target } = framed(sample);
      expect(side * (position[2] - target[2])).toBeGreaterThan(0.5 * length(minus(position, target)));
    }
  });

  test('an upright picture shows all of an object too', () => {
    const sample = statue().sample();
    expect(partInPicture(sample, framed(sample, { aspect: 0.5 }), 0.5)).toBeGreaterThan(0.98);
  });

  test('a place is looked at from within its sky, above its ground', () => {
    const framing = framingOf(park);
    expect(framing.kind).toBe('surrounded');
    expect(length(framing.position)).toBeLessThan(12);
    expect(partInPicture(statue().sample(), framing)).toBeGreaterThan(0.6);
    expect(dot(framing.position, framing.up)).toBeGreaterThan(0.1);
    expect(Math.abs(framing.groundHeight!)).toBeLessThan(0.1);
  });

  test('a room is looked at from within', () => {
    for (const turn of [Y_DOWN, Z_UP]) {
      const { kind, position, up } = framingOf(room, turn);
      expect(kind).toBe('enclosed');
      const height = dot(position, up);
      expect(height).toBeGreaterThan(0.5);
      expect(height).toBeLessThan(2.3);
      expect(length(position)).toBeLessThan(4.4);
    }
  });

  test('a scene is of the same kind in windows of any aspect ratio', { tags: 'deeper' }, () => {
    const isFull = process.env.WEBSPLATTER_FULL === '1';
    for (const make of [statue, park, room])
      for (const [turn, few] of [
        [Y_DOWN, [0.46, 2.4]],
        [Z_UP, []],
      ] as const) {
        const sample = make().sample(turn);
        const { kind, up } = framingOf(make, turn);
        for (const aspect of isFull ? [0.46, 1, 2.4] : few)
          expect(framed(sample, { aspect }), `${make.name}, ${aspect}`).toMatchObject({ kind, up });
      }
  });

  test('a wanted kind is taken', () => {
    const framing = framed(room().sample(), { kind: 'object' });
    expect(framing.kind).toBe('object');
    expect(partInPicture(room().sample(), framing)).toBeGreaterThan(0.98);
  });
});

describe('traps', () => {
  const reference = framingOf(statue);

  test('strays far away, and failed splats at one point, change little', () => {
    const strays = statue()
      .cloud([-2000, -2000, -2000], [3000, 2000, 2000], 800, 5)
      .cloud([40, 40, 40], [40, 40, 40], 400, 0.01);
    const framing = framed(strays.sample());
    expect(length(minus(framing.center, reference.center))).toBeLessThan(0.2);
    expect(length(minus(framing.position, framing.center))).toBeLessThan(12);
    expect(framing.up).toEqual([0, -1, 0]);
  });

  test('many failed splats at one point, up to a tenth of all, change little', () => {
    const piled = statue();
    const pile = piled.sample().count / 9;
    const framing = framed(piled.cloud([40, 40, 40], [40, 40, 40], pile, 0.01).sample());
    expect(length(minus(framing.center, reference.center))).toBeLessThan(0.3);
    expect(length(minus(framing.position, framing.center))).toBeLessThan(12);
  });

  test('fog on one side: the camera looks from another', () => {
    for (const side of [-1, 1]) {
      const fog = statue().cloud([side * 2 - 0.5, 0, -3], [side * 2 + 0.5, 3, 3], 300, 0.5, 0.6);
      const { position, target } = framed(fog.sample(), { kind: 'object' });
      expect(side * (position[0] - target[0])).toBeLessThan(0.5 * length(minus(position, target)));
    }
  });

  test('far from the origin, huge or tiny, it is the same camera', () => {
    const offset: Vec3 = [5e6, -3e6, 1e7];
    const far = framed(statue().sample(Y_DOWN, 1, offset));
    expect(length(minus(minus(far.position, offset), reference.position))).toBeLessThan(1e-3);
    for (const scale of [1e-6, 1e6]) {
      const { position } = framed(statue().sample(Y_DOWN, scale));
      expect(
        length(minus(position.map((value) => value / scale) as unknown as Vec3, reference.position)),
      ).toBeLessThan(1e-3);
    }
  });

  test('one splat, and many at one point, are looked at from some of their sizes away', () => {
    for (const count of [1, 300]) {
      const { position, target, radius } = framed(
        new MadeScene().cloud([1, 2, 3], [1, 2, 3], count, 0.1).sample(),
      );
      expect(length(minus(target, [1, -2, -3]))).toBeLessThan(0.5);
      expect(length(minus(position, target))).toBeGreaterThan(0.2);
      expect(length(minus(position, target))).toBeLessThan(5);
      expect(radius).toBeGreaterThan(0);
    }
  });

  test('a plane is not looked at from its edge', () => {
    const wall = new MadeScene()
      .rectangle(
        [-1, -1, 0],
        [
          [2, 0, 0],
          [0, 2, 0],
        ],
        3000,
      )
      .sample();
    const framing = framed(wall);
    const { position, target } = framing;
    expect(partInPicture(wall, framing)).toBeGreaterThan(0.98);
    const back = minus(position, target);
    expect(Math.abs(back[2])).toBeGreaterThan(0.5 * length(back));
  });

  test('of two far clusters, at least one is in the picture', () => {
    const one = new MadeScene().box([-1, -1, -1], [1, 1, 1], 500);
    const two = new MadeScene().box([-1, -1, -1], [1, 1, 1], 500).box([999, -1, -1], [1001, 1, 1], 500);
    const framing = framed(two.sample());
    const whole = partInPicture(two.sample(), framing);
    expect(Math.max(whole, partInPicture(one.sample(), framing))).toBeGreaterThan(0.9);
    expect(Number.isFinite(length(framing.position))).toBe(true);
  });

  test('splats that are not finite, or have no opacity, do not count', () => {
    const sample = statue().sample();
    const { count, positions, opacities } = sample;
    for (let i = 0; i < count; i += 7) positions[3 * i] = Number.NaN;
    for (let i = 3; i < count; i += 7) opacities[i] = 0;
    expect(length(minus(framed(sample).center, reference.center))).toBeLessThan(0.1);
  });

  test('nothing that can be seen has no camera', () => {
    expect(frameSample(new MadeScene().sample(), WISHES)).toBeNull();
    const faint = statue().sample();
    faint.opacities.fill(0);
    expect(frameSample(faint, WISHES)).toBeNull();
  });

  test('faint scenes have one', () => {
    const faint = statue().sample();
    faint.opacities.fill(0.01);
    expect(framed(faint).kind).toBe('object');
  });
});

test('the camera is the same, bit for bit, on every machine', () => {
  expect([statue, park, room].map((make) => framingOf(make).position)).toEqual([
    [-0.34191332208542125, -1.6101333803851978, 3.697777038299006],
    [0.10843897656880566, -1.0964968235318822, -1.9572074188653545],
    [1.4285332815987728, -1.3000198364257813, -2.9979934692382812],
  ]);
});
