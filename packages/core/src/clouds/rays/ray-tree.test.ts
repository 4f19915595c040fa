import { stillLifeCameras } from '@websplatter/scenes';
import { afterEach, describe, expect, test, vi } from 'vitest';
import type { Vec3 } from '../../data/math/mat4.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { splatsAt } from '../../features/motion/splats-at.data.ts';
import { fakeWorker } from '../../testing/fake-worker.ts';
import { movingSplats } from '../../testing/moving-splats.ts';
import { objectScene } from '../../testing/object-scene.ts';
import { expectRaysAsShown, partWithin2Percent, randomRays } from '../../testing/random-rays.ts';
import { randomSplats, type SplatValues, splatsOf } from '../../testing/random-splats.ts';
import { stillLife } from '../../testing/still-life.ts';
import { builderTasks } from '../geometry-builder.ts';
import { makeRayTree } from './make-ray-tree.ts';
import type { RayTree } from './ray-tree.ts';
import { RAY_BUILDERS } from './ray-tree-builder.ts';

const pack = (set: SplatSet<Harmonics>) => packCloud(set, { geometryPrecision: 'packed' });
const treeOf = (splats: readonly SplatValues[]) => makeRayTree(pack(splatsOf(splats)), {});
const small = { logScales: [-3, -3, -3], opacityLogit: 9 } as const;

describe('a ray', () => {
  test('hits a splat at its middle, in units of the direction, about the origin of the cloud', async () => {
    const tree = await makeRayTree(
      pack({ ...splatsOf([{ position: [0.5, 1, 3], ...small }]), origin: [6.4e6, 0, 0] }),
      {},
    );
    const hit = tree.cast([6.4e6 + 0.5, 1, 10], [0, 0, -2]);
    expect(hit?.distance).toBeCloseTo(3.5, 3);
    expect(hit?.point[0]).toBe(6.4e6 + 0.5);
    expect(hit?.point[2]).toBeCloseTo(3, 3);
    expect(tree.cast([6.4e6 + 0.5, 1, 10], [0, 0, 1])).toBeNull();
    // Half as wide as three standard deviations.
    expect(tree.cast([6.4e6 + 0.55, 1, 10], [0, 0, -1])?.distance).toBeCloseTo(7, 3);
    expect(tree.cast([6.4e6 + 0.7, 1, 10], [0, 0, -1])).toBeNull();
  });

  test('that is not finite or has no direction, and rays at nothing, hit nothing', async () => {
    const one = await treeOf([{ position: [0, 0, 0], ...small }]);
    expect(one.cast([0, 0, 5], [0, 0, 0])).toBeNull();
    expect(one.cast([0, 0, Number.NaN], [0, 0, -1])).toBeNull();
    expect(one.cast([0, 0, 5], [0, 0, Number.NEGATIVE_INFINITY])).toBeNull();
    expect((await treeOf([])).cast([0, 0, 5], [0, 0, -1])).toBeNull();
  });

  test('leaves out splats that it begins inside of', async () => {
    const tree = await treeOf([
      { position: [0, 0, 0.1], logScales: [1, 1, 1], opacityLogit: 9 },
      { position: [0, 0, -9], ...small },
    ]);
    expect(tree.cast([0, 0, 0], [0, 0, -1])?.distance).toBeCloseTo(9, 3);
    expect(tree.cast([0, 0, 0.5], [0, 0, -1])?.distance).toBeCloseTo(9.5, 3);
    expect(tree.cast([0, 0, 20], [0, 0, -1])?.distance).toBeCloseTo(19.9, 3);
  });

  test('passes splats that are too faint, and hits those that are opaque enough together', async () => {
    const faint = { logScales: [-3, -3, -3], opacityLogit: Math.log(0.2 / 0.8) } as const;
    const tree = await treeOf([
      { position: [0, 0, 0], ...faint },
      { position: [0, 0, -1], ...faint },
      { position: [1, 0, 0], ...faint },
    ]);
    expect(tree.cast([0, 0, 5], [0, 0, -1])?.distance).toBeCloseTo(5, 3);
    expect(tree.cast([1, 0, 5], [0, 0, -1])).toBeNull();
    expect(tree.cast([1, 0, 5], [0, 0, -1], { minOpacity: 0.1 })?.distance).toBeCloseTo(5, 3);
    expect(tree.cast([0, 0, 5], [0, 0, -1], { opacity: 0.5 })).toBeNull();
    expect(tree.cast([0, 0, 5], [0, 0, -1], { opacity: 0, minOpacity: 0 })).toBeNull();
  });

  test('goes on until what it has hit is opaque enough, however heavy one splat is', async () => {
    // Each row is a node of the tree.
    const rows = [0, -50, -100].flatMap((z) =>
      Array.from({ length: 8 }, (_, x) => ({ position: [x, 0, z], ...small, opacityLogit: Math.log(1.5) })),
    );
    const tree = await treeOf(rows);
    // Two have 0.84, all three 0.936.
    for (const minOpacity of [0.5, 0.8, 0.9])
      expect(tree.cast([0, 0, 5], [0, 0, -1], { minOpacity })?.distance).toBeCloseTo(5, 3);
    expect(tree.cast([0, 0, 5], [0, 0, -1], { minOpacity: 0.95 })).toBeNull();
  });

  test('meets a ball at its side from any direction', async () => {
    const tree = await treeOf([{ position: [0, 0, 0], logScales: [0, 0, 0], opacityLogit: 9 }]);
    for (const [x, y, z] of [
      [1, 0, 0],
      [1, 1, 0],
      [-1, 1, 0],
      [1, 0, -1],
      [0, 1, 1],
      [1, 2, 3],
    ])
      for (const side of [
        [y, -x, 0],
        [0, z, -y],
        [z, 0, -x],
      ]) {
        const length = Math.hypot(...side);
        if (length === 0) continue;
        const at = (deviations: number) =>
          side.map((value) => (deviations * value) / length) as unknown as Vec3;
        const from = (deviations: number): Vec3 => {
          const [sideX, sideY, sideZ] = at(deviations);
          return [sideX - 50 * x, sideY - 50 * y, sideZ - 50 * z];
        };
        expect(tree.cast(from(1.4), [x, y, z])?.distance).toBeCloseTo(50, 3);
        expect(tree.cast(from(1.7), [x, y, z])).toBeNull();
      }
  });

  test('meets a disc that is as thin as can be, however it is turned about its normal', async () => {
    const half = Math.SQRT1_2;
    for (let turn = 0; turn < 8; turn++) {
      const angle = 0.2 + (Math.PI * turn) / 8;
      const [sine, cosine] = [Math.sin(angle / 2), Math.cos(angle / 2)];
      // About y by the angle, then about z by 45°: the normal becomes that of the plane x = y.
      const [inY, inZ] = [Math.sin(Math.PI / 8), Math.cos(Math.PI / 8)];
      const rotation = [inZ * cosine, -inY * sine, inZ * sine, inY * cosine];
      const disc = { logScales: [0, -60, -2], rotation, opacityLogit: 9 };
      const tree = await makeRayTree(packCloud(splatsOf([disc]), { geometryPrecision: 'f32' }), {});
      const [along, up] = [Math.cos(angle), -Math.sin(angle)];
      const cast = (x: number, z: number) => tree.cast([half * x - 5, half * x + 5, z], [1, -1, 0]);
      expect(cast(1.2 * along, 1.2 * up)?.distance, `at ${angle}`).toBeCloseTo(5, 3);
      expect(cast(0.6 * up, -0.6 * along), `beside ${angle}`).toBeNull();
    }
  });

  test('has a range, and passes hidden splats', async () => {
    const tree = await treeOf([
      { position: [0, 0, 0], ...small },
      { position: [0, 0, -3], ...small },
    ]);
    const cast = (options: Parameters<RayTree['cast']>[2]) =>
      tree.cast([0, 0, 10], [0, 0, -2], options)?.distance;
    expect(cast({ near: 5.1 })).toBeCloseTo(6.5, 3);
    expect(cast({ near: 4.9, far: 5.1 })).toBeCloseTo(5, 3);
    expect(cast({ far: 4.9 })).toBeUndefined();
    expect(cast({ shownAt: (_x, _y, z) => (z < -1 ? 1 : 0) })).toBeCloseTo(6.5, 3);
  });

  test('along an axis meets splats on the faces of boxes', async () => {
    const splats = Array.from({ length: 64 }, (_, i) => ({
      position: [i % 8, i >> 3, 0] as const,
      ...small,
    }));
    const tree = await treeOf(splats);
    for (const { position } of splats) {
      const [x, y] = position;
      expect(tree.cast([x, y, 4], [0, 0, -1])?.distance).toBeCloseTo(4, 3);
      expect(tree.cast([x, y, -4], [0, -0, 1])?.distance).toBeCloseTo(4, 3);
    }
    expect(tree.cast([-4, 3, 0], [1, 0, 0])?.distance).toBeCloseTo(4, 3);
  });
});

describe('a tree', () => {
  test('has a blob for each splat that can be seen, where there are few', async () => {
    const splats = randomSplats({ count: 700, shDegree: 0, logScales: [-5, -4] });
    splats.opacityLogits.fill(2);
    splats.opacityLogits.fill(-6, 0, 100);
    expect((await makeRayTree(pack(splats), {})).count).toBe(600);
  });

  test('takes no more memory for more splats than it may', async () => {
    const splats = randomSplats({ count: 40_000, shDegree: 0, logScales: [-5, -4] });
    const tree = await makeRayTree(pack(splats), { mostBlobs: 2000 });
    expect(tree.count).toBeLessThanOrEqual(2000);
    expect(tree.bytes / tree.count).toBeLessThan(24);
  });

  test('is not made once its signal aborts', async () => {
    const stop = AbortSignal.abort(new Error('enough'));
    await expect(makeRayTree(pack(splatsOf([{}])), { signal: stop })).rejects.toThrow('enough');
  });
});

describe('1,000 random rays, against picks of the reference,', () => {
  test('at a still life hit within 2 % of the depth, wherever splats cover a pixel', async () => {
    const set = await stillLife();
    const rays = randomRays(set, stillLifeCameras.slice(0, 5));
    expect(partWithin2Percent(await makeRayTree(pack(set), {}), rays)).toBeGreaterThanOrEqual(0.999);
  });

  test('at an object alone all hit within 2 % of the depth, and miss where fewer than 10 % is covered', async () =>
    expectRaysAsShown(await objectScene()));
});

describe('a ray at a moving cloud', () => {
  const set = movingSplats({ count: 400, seed: 8, shDegree: 0, logScales: [-4, -2] });

  for (const geometryPrecision of ['packed', 'f32'] as const)
    test(`of ${geometryPrecision} splats meets it as it is at a time, by default the first`, async () => {
      const cloud = packCloud(set, { geometryPrecision, shPrecision: 'u8' });
      let hits = 0;
      for (const time of [undefined, 0, 0.3, 1, 7]) {
        const frozen = splatsAt(set, Math.min(time ?? 0, 1));
        const [tree, still] = [await makeRayTree(cloud, { time }), await makeRayTree(pack(frozen), {})];
        for (let i = 0; i < 200; i++) {
          const origin = [4 * Math.cos(i), Math.sin(3 * i), 4 * Math.sin(i)] as const;
          const direction = origin.map((value, axis) => Math.sin(5 * i + axis) - value) as unknown as Vec3;
          const [moving, expected] = [tree, still].map((each) => each.cast(origin, direction));
          // Rounding decides about a ray at the rim of a splat.
          if (!moving || !expected) continue;
          hits++;
          expect(Math.abs(moving.distance / expected.distance - 1)).toBeLessThan(0.02);
        }
      }
      expect(hits).toBeGreaterThan(300);
    });

  test('needs a time that is a number', async () => {
    for (const time of [Number.NaN, Number.POSITIVE_INFINITY, '1' as never])
      await expect(makeRayTree(pack(set), { time })).rejects.toThrow(/time.*finite number/);
  });
});

describe('a ray tree that a worker makes', () => {
  const FakeWorker = fakeWorker(() => builderTasks(RAY_BUILDERS));
  afterEach(() => vi.unstubAllGlobals());

  test('is that of this thread, and leaves the splats where they are', async () => {
    const cloud = pack(randomSplats({ count: 3000 }));
    const here = await makeRayTree(cloud, { mostBlobs: 500 });
    vi.stubGlobal('Worker', FakeWorker);
    const there = await makeRayTree(cloud, { mostBlobs: 500 });
    expect(FakeWorker.started).toHaveLength(1);
    expect(FakeWorker.started[0].isTerminated).toBe(true);
    expect([there.count, there.bytes]).toEqual([here.count, here.bytes]);
    for (let i = 0; i < 50; i++) {
      const direction: Vec3 = [Math.sin(i), Math.cos(i), -3];
      expect(there.cast([0, 0, 5], direction)).toEqual(here.cast([0, 0, 5], direction));
    }
  });
});
