import { afterEach, describe, expect, test, vi } from 'vitest';
import { DestroyedError, InvalidArgumentError, WebSplatterError } from '../../data/errors.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { type PackedCloud, packCloud } from '../../data/packing/packed-cloud.ts';
import { MOTION_SLOT, MOTION_VALUES } from '../../features/motion/splat-motion.data.ts';
import { fakeWorker } from '../../testing/fake-worker.ts';
import { movingSplats } from '../../testing/moving-splats.ts';
import { randomSplats, type SplatValues, splatsOf } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { builderTasks } from '../geometry-builder.ts';
import { COLLIDER_BUILDERS } from './build-collider.ts';
import { type ColliderMesh, makeColliderMesh } from './make-collider-mesh.ts';

const PRECISION = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;

const packed = (values: readonly SplatValues[]): PackedCloud => packCloud(splatsOf(values), PRECISION);

/** Flat splats on a sphere, as opaque as trained surfaces are. */
function ball(radius: number, [x, y, z]: Vec3 = [0, 0, 0], count = 3000): SplatValues[] {
  return Array.from({ length: count }, (_, i) => {
    // Fibonacci's sphere.
    const height = 1 - (2 * (i + 0.5)) / count;
    const angle = i * Math.PI * (3 - Math.sqrt(5));
    const across = Math.sqrt(1 - height * height);
    const normal = [across * Math.cos(angle), height, across * Math.sin(angle)] as const;
    const size = Math.log((2 * radius) / Math.sqrt(count));
    return {
      position: [x + radius * normal[0], y + radius * normal[1], z + radius * normal[2]],
      logScales: [size, size, Math.log(0.002 * radius)],
      rotation: turning([0, 0, 1], normal),
      opacityLogit: 3,
    };
  });
}

/** The rotation, w first, that turns one direction into another. */
function turning(from: Vec3, to: Vec3): [number, number, number, number] {
  const w = 1 + from[0] * to[0] + from[1] * to[1] + from[2] * to[2];
  const [x, y, z] = [
    from[1] * to[2] - from[2] * to[1],
    from[2] * to[0] - from[0] * to[2],
    from[0] * to[1] - from[1] * to[0],
  ];
  const length = Math.hypot(w, x, y, z);
  return length < 1e-9 ? [0, 1, 0, 0] : [w / length, x / length, y / length, z / length];
}

/** Signed volume, which is right for closed surfaces alone, whose triangles face outwards. */
function volumeOf({ positions, indices }: ColliderMesh): number {
  let volume = 0;
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => positions.subarray(3 * indices[i + k], 3 * indices[i + k] + 3));
    volume +=
      a[0] * (b[1] * c[2] - b[2] * c[1]) +
      a[1] * (b[2] * c[0] - b[0] * c[2]) +
      a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return volume / 6;
}

/** Edges that do not lie between two triangles, once in each direction. */
function openEdgesOf({ indices, positions }: ColliderMesh): number {
  const edges = new Map<number, number>();
  for (let i = 0; i < indices.length; i += 3) {
    for (let k = 0; k < 3; k++) {
      const [from, to] = [indices[i + k], indices[i + ((k + 1) % 3)]];
      const key = Math.min(from, to) * positions.length + Math.max(from, to);
      edges.set(key, (edges.get(key) ?? 0) + (from < to ? 1 : -1));
    }
  }
  return [...edges.values()].filter((sum) => sum !== 0).length;
}

/** Compares meshes bit by bit. */
function expectSame(a: ColliderMesh, b: ColliderMesh): void {
  expect(a.cellSize).toBe(b.cellSize);
  expect(Buffer.from(a.positions.buffer).equals(Buffer.from(b.positions.buffer))).toBe(true);
  expect(Buffer.from(a.indices.buffer).equals(Buffer.from(b.indices.buffer))).toBe(true);
}

const radiiOf = ({ positions }: ColliderMesh, [x, y, z]: Vec3 = [0, 0, 0]) =>
  Array.from({ length: positions.length / 3 }, (_, i) =>
    Math.hypot(positions[3 * i] - x, positions[3 * i + 1] - y, positions[3 * i + 2] - z),
  );

afterEach(() => vi.unstubAllGlobals());

describe('a collider', () => {
  test('is closed, faces outwards, and lies within a cell of what is opaque', async () => {
    const mesh = await makeColliderMesh(packed(ball(2)), { cellSize: 0.2 });
    expect(openEdgesOf(mesh)).toBe(0);
    expect(mesh.indices.length / 3).toBeGreaterThan(2000);
    // A shell: its inner side is a surface as well.
    const radii = radiiOf(mesh);
    expect(Math.max(...radii)).toBeLessThan(2 + mesh.cellSize);
    expect(Math.max(...radii)).toBeGreaterThan(2);
    expect(Math.min(...radii)).toBeGreaterThan(2 - mesh.cellSize);
    const shell = (4 / 3) * Math.PI * (Math.max(...radii) ** 3 - Math.min(...radii) ** 3);
    expect(volumeOf(mesh)).toBeGreaterThan(0.4 * shell);
    expect(volumeOf(mesh)).toBeLessThan(shell);
  });

  test('has no holes where one layer of opaque splats is, wherever it lies between cells', async () => {
    const random = seededRandom(3);
    for (let i = 0; i < 6; i++) {
      const height = random();
      const sheet = Array.from(
        { length: 400 },
        (_, k): SplatValues => ({
          position: [(k % 20) - 9.5, height, Math.floor(k / 20) - 9.5],
          logScales: [Math.log(0.9), Math.log(0.001), Math.log(0.9)],
          opacityLogit: 2,
        }),
      );
      const bounds = { min: [-8, -2, -8], max: [8, 3, 8] } as const;
      const mesh = await makeColliderMesh(packed(sheet), { cellSize: 0.5, bounds });
      expect(openEdgesOf(mesh)).toBe(0);
      // A sheet without holes is one ball, topologically.
      const vertices = mesh.positions.length / 3;
      const triangles = mesh.indices.length / 3;
      expect(vertices - triangles / 2, `sheet at ${height}`).toBe(2);
    }
  });

  test('has no holes either where splats are far smaller than a cell', async () => {
    const side = 150;
    const [spacing, size] = [0.02, Math.log(0.015)];
    const sheet = Array.from(
      { length: side ** 2 },
      (_, k): SplatValues => ({
        position: [spacing * (k % side), 0.1, spacing * Math.floor(k / side)],
        logScales: [size, Math.log(0.001), size],
        opacityLogit: 2,
      }),
    );
    const bounds = { min: [0.5, -1, 0.5], max: [2.5, 1, 2.5] } as const;
    const mesh = await makeColliderMesh(packed(sheet), { cellSize: 0.5, bounds, fewestTriangles: 0 });
    expect(openEdgesOf(mesh)).toBe(0);
    expect(mesh.positions.length / 3 - mesh.indices.length / 6).toBe(2);
    expect(volumeOf(mesh)).toBeGreaterThan(1);
  });

  test('leaves out faint splats, ones as large as the sky, and ones that float about alone', async () => {
    const faint = ball(1, [5, 0, 0]).map((values) => ({ ...values, opacityLogit: -4.5 }));
    const sky = [{ position: [0, 0, 0] as const, logScales: [3, 3, 3] as const, opacityLogit: 4 }];
    const speck = [{ position: [0, 4, 0] as const, logScales: [-2, -2, -2] as const, opacityLogit: 4 }];
    const bounds = { min: [-3, -3, -3], max: [7, 5, 3] } as const;
    const values = [...ball(2), ...faint, ...sky, ...speck];
    const options = { cellSize: 0.25, bounds };
    const mesh = await makeColliderMesh(packed(values), options);
    expect(Math.max(...radiiOf(mesh))).toBeLessThan(2.25);
    const withSpeck = await makeColliderMesh(packed(values), { ...options, fewestTriangles: 0 });
    expect(Math.max(...radiiOf(withSpeck))).toBeGreaterThan(3.5);
    expect(openEdgesOf(withSpeck)).toBe(0);
  });

  test('of a part of a cloud is closed at its sides', async () => {
    const bounds = { min: [-3, -3, -3], max: [3, 0, 3] } as const;
    const mesh = await makeColliderMesh(packed(ball(2)), { cellSize: 0.2, bounds });
    expect(openEdgesOf(mesh)).toBe(0);
    for (let i = 1; i < mesh.positions.length; i += 3) expect(mesh.positions[i]).toBeLessThan(0.4);
  });

  test('is where the cloud is, far from the origin too', async () => {
    const middle = [1000, -50, 20] as const;
    const mesh = await makeColliderMesh(packed(ball(2, middle)), { cellSize: 0.25 });
    const radii = radiiOf(mesh, middle);
    expect(Math.max(...radii)).toBeLessThan(2.25);
    expect(Math.min(...radii)).toBeGreaterThan(1.75);
  });

  test('is the same every time, and of either precision nearly so', async () => {
    const options = { cellSize: 0.1 };
    const first = await makeColliderMesh(packed(ball(1)), options);
    expectSame(await makeColliderMesh(packed(ball(1)), options), first);
    const exact = packCloud(splatsOf(ball(1)), { ...PRECISION, geometryPrecision: 'f32' });
    const mesh = await makeColliderMesh(exact, options);
    expect(Math.abs(volumeOf(mesh) / volumeOf(first) - 1)).toBeLessThan(0.01);
  });

  test('has cells of a ninety-sixth of the longest side, unless asked otherwise', async () => {
    const bounds = { min: [-1, -1, -1], max: [1, 0, 8.6] } as const;
    expect((await makeColliderMesh(packed(ball(1, [0, 0, 0], 300)), { bounds })).cellSize).toBeCloseTo(
      0.1,
      9,
    );
  });

  test('of a moving cloud is where that is at a time', async () => {
    const set = splatsOf(ball(1));
    const motion = new Float32Array(MOTION_VALUES * set.count);
    for (let i = 0; i < set.count; i++) {
      motion[MOTION_VALUES * i + MOTION_SLOT.logDuration] = 5;
      motion[MOTION_VALUES * i + MOTION_SLOT.velocity] = 3;
    }
    const cloud = packCloud({ ...set, motion }, PRECISION);
    const bounds = { min: [-2, -2, -2], max: [6, 2, 2] } as const;
    for (const time of [undefined, 0.5, 1]) {
      const mesh = await makeColliderMesh(cloud, { cellSize: 0.1, bounds, time });
      const radii = radiiOf(mesh, [3 * (time ?? 0), 0, 0]);
      expect(Math.max(...radii)).toBeLessThan(1.1);
      expect(Math.min(...radii)).toBeGreaterThan(0.9);
    }
    // The cloud's own bounds are those of its splats as trained.
    await expect(makeColliderMesh(cloud, { time: 0.5 })).rejects.toThrow(/^bounds .*given with `time`/);
    await expect(makeColliderMesh(cloud, { time: Number.NaN })).rejects.toThrow(/time.*finite number/);
  });

  test('of packed splats whose motion is none is refused by name', async () => {
    const cloud = packCloud(movingSplats({ count: 10 }), PRECISION);
    const { motion } = cloud;
    for (const [wrong, argument] of [
      [{}, 'packed.motion.range'],
      [{ ...motion, words: undefined }, 'packed.motion.words'],
      [{ ...motion, range: [Number.NaN, 1] }, 'packed.motion.range'],
      [{ ...motion, range: [1] }, 'packed.motion.range'],
      [{ ...motion, range: [1, 0] }, 'packed.motion.range'],
    ] as const)
      await expect(makeColliderMesh({ ...cloud, motion: wrong as never })).rejects.toMatchObject({
        name: 'InvalidArgumentError',
        argument,
      });
  });

  test('is empty where nothing is', async () => {
    const none = { positions: new Float32Array(), indices: new Uint32Array() };
    expect(await makeColliderMesh(packed([]), { cellSize: 1 })).toEqual({ ...none, cellSize: 1 });
    const faint = packed([{ opacityLogit: -6 }]);
    expect(await makeColliderMesh(faint, { cellSize: 1 })).toEqual({ ...none, cellSize: 1 });
  });

  test('of any splats is closed', async () => {
    for (let seed = 1; seed <= 4; seed++) {
      const splats = packCloud(randomSplats({ count: 500, seed, logScales: [-6, 0] }), PRECISION);
      const mesh = await makeColliderMesh(splats, { cellSize: 0.1, fewestTriangles: 0 });
      expect(openEdgesOf(mesh), `seed ${seed}`).toBe(0);
      expect(mesh.positions.every(Number.isFinite)).toBe(true);
    }
  });

  test.each([
    [{ cellSize: 0 }, 'cellSize is 0'],
    [{ cellSize: Number.NaN }, 'cellSize is NaN'],
    [{ cellSize: 1e-4 }, 'are more than 16777216. Make them at least'],
    [{ solidAt: 1 }, 'solidAt is 1'],
    [{ solidAt: -0.1 }, 'solidAt is -0.1'],
    [{ fewestTriangles: 1.5 }, 'fewestTriangles is 1.5'],
    [{ bounds: { min: [0, 0, 0], max: [1, -1, 1] } as const }, 'The bounds are'],
    [{ bounds: { min: [0, 0, Number.NEGATIVE_INFINITY], max: [1, 1, 1] } as const }, 'The bounds are'],
  ])('names what is wrong with %j', async (options, message) => {
    const making = makeColliderMesh(packed(ball(1)), options);
    await expect(making).rejects.toThrow(InvalidArgumentError);
    await expect(making).rejects.toThrow(message);
  });

  test('says by how much cells must be larger, and that is enough', async () => {
    const cloud = packed(ball(1));
    const error: Error = await makeColliderMesh(cloud, { cellSize: 1e-4 }).catch((reason) => reason);
    const least = Number(/at least ([\d.e-]+),/.exec(error.message)![1]);
    expect(least).toBeGreaterThan(2 / 260);
    expect(least).toBeLessThan(2 / 220);
    const abort = new AbortController();
    const making = makeColliderMesh(cloud, { cellSize: least, signal: abort.signal });
    abort.abort(new Error('enough'));
    await expect(making).rejects.toThrow('enough');
  });

  test('tells how far it is, and can be called off', async () => {
    const parts: number[] = [];
    const cloud = packCloud(
      randomSplats({ count: 70_000, seed: 1, shDegree: 0, logScales: [-6, -5] }),
      PRECISION,
    );
    await makeColliderMesh(cloud, { cellSize: 0.2, onProgress: (part) => parts.push(part) });
    expect(parts).toHaveLength(4);
    expect(parts.toSorted((a, b) => a - b)).toEqual(parts);
    expect(parts.at(-1)).toBe(1);
    const abort = new AbortController();
    const reason = new Error('no longer needed');
    const onProgress = () => abort.abort(reason);
    await expect(makeColliderMesh(cloud, { cellSize: 0.2, signal: abort.signal, onProgress })).rejects.toBe(
      reason,
    );
    await expect(makeColliderMesh(cloud, { signal: AbortSignal.abort(reason) })).rejects.toBe(reason);
  });
});

const FakeWorker = fakeWorker(() => builderTasks(COLLIDER_BUILDERS));

describe('in a worker, a collider', () => {
  afterEach(() => {
    for (const worker of FakeWorker.started) expect(worker.isTerminated).toBe(true);
    FakeWorker.started = [];
  });

  test('is the same, and the cloud keeps its splats', async () => {
    const cloud = packed(ball(1));
    const options = { cellSize: 0.1 };
    const expected = await makeColliderMesh(cloud, options);
    vi.stubGlobal('Worker', FakeWorker);
    expectSame(await makeColliderMesh(cloud, options), expected);
    expectSame(await makeColliderMesh(cloud, options), expected);
    expect(FakeWorker.started).toHaveLength(2);
  });

  test('fails with the worker, and ends it when it is called off', async () => {
    vi.stubGlobal('Worker', FakeWorker);
    FakeWorker.behaviour = 'dies';
    const dying = makeColliderMesh(packed(ball(1)));
    await expect(dying).rejects.toThrow(WebSplatterError);
    await expect(dying).rejects.toThrow('the worker stopped: out of memory');
    FakeWorker.behaviour = 'works';
    const abort = new AbortController();
    const onProgress = () => abort.abort(new DestroyedError('The page', 'it was left'));
    const making = makeColliderMesh(packed(ball(1)), { signal: abort.signal, onProgress });
    await expect(making).rejects.toThrow(DestroyedError);
  });
});
