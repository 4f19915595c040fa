import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { type Camera, perspectiveCamera } from '../../data/camera/camera.ts';
import { cloudView } from '../../data/camera/cloud-view.ts';
import { orderedBits, orderedWords, sortDistance } from '../../data/layout/depth-key.ts';
import { identity4, type Mat4 } from '../../data/math/mat4.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { anyCamera, anyModel } from '../../testing/any-view.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { uniform } from '../../testing/uniform.ts';
import { keyBitsFor, wideKeysFor } from './key-bits.ts';

function planned({ viewMatrix }: Camera, set: SplatSet, modelMatrix: Mat4 = identity4()) {
  const cloud = packCloud(set, { geometryPrecision: 'f32' }) as unknown as SplatCloud;
  const view = cloudView(viewMatrix, modelMatrix, set.origin, false);
  return { instance: { cloud }, view, reach: { displacement: 0, growth: 1 } };
}

/** Keys of the splats between near and far in float32, each operation rounded: none is fused. */
function keysOf(set: SplatSet, camera: Camera, modelMatrix: Mat4, isByDistance: boolean): number[] {
  const f = Math.fround;
  const { linear, translation } = cloudView(camera.viewMatrix, modelMatrix, set.origin, false);
  return Array.from({ length: set.count }, (_, i) => {
    const [x, y, z] = [0, 1, 2].map((row) => {
      let sum = f(f(linear[row]) * set.positions[3 * i]);
      sum = f(sum + f(f(linear[row + 3]) * set.positions[3 * i + 1]));
      sum = f(sum + f(f(linear[row + 6]) * set.positions[3 * i + 2]));
      return f(sum + f(translation[row]));
    });
    const scale = sortDistance(1, camera.near) ** 0.5;
    const [a, b, c] = [x, y, z].map((value) => f(value * scale));
    return { depth: -z, distance: f(f(f(a * a) + f(b * b)) + f(c * c)) };
  })
    .filter(({ depth }) => depth > f(camera.near) && depth <= f(camera.far))
    .map(({ depth, distance }) => orderedBits(isByDistance ? distance : depth));
}

const rangeOf = (keys: readonly number[]) => (keys.length > 0 ? Math.max(...keys) - Math.min(...keys) : 0);

describe('keyBitsFor', () => {
  test('bounds the bits in which keys of any splats in the depth range differ', () => {
    const coordinate = uniform(-50, 50);
    const scene = fc.record({
      seed: fc.nat(),
      halfExtent: fc.constantFrom(1e-4, 0.01, 1, 30),
      // Away from the file's origin, with the origin of the positions somewhere else again.
      origin: fc.oneof(fc.constant([0, 0, 0] as const), fc.tuple(coordinate, coordinate, coordinate)),
    });
    fc.assert(
      fc.property(anyCamera, anyModel, scene, fc.boolean(), (camera, modelMatrix, options, isByDistance) => {
        const set = randomSplats({ count: 50, shDegree: 0, ...options });
        const bits = keyBitsFor(camera, [planned(camera, set, modelMatrix)], isByDistance);
        expect(rangeOf(keysOf(set, camera, modelMatrix, isByDistance))).toBeLessThan(2 ** bits);
      }),
      { numRuns: 500 },
    );
  });

  test('counts the rounding of large terms for positions far from the origin that they are relative to', () => {
    const coordinate = uniform(-1, 1);
    const direction = fc
      .tuple(coordinate, coordinate, coordinate)
      .filter((d) => Math.hypot(d[0], d[2]) > 0.1);
    const distance = uniform(1e-4, 1e-2);
    fc.assert(
      fc.property(direction, distance, fc.nat(), fc.boolean(), (d, far, seed, isByDistance) => {
        const position = [d[0] * far, d[1] * far, d[2] * far] as const;
        const camera = perspectiveCamera({
          position,
          target: [0, 0, 0],
          fovYDegrees: 60,
          aspect: 1,
          near: 1e-7,
        });
        // The splats lie at the world's origin, but their own origin does not.
        const origin = [700, -1000, 900] as const;
        const set = randomSplats({ count: 100, shDegree: 0, halfExtent: 1e-4, origin, seed });
        for (let i = 0; i < 3 * set.count; i++) set.positions[i] -= origin[i % 3];
        const bits = keyBitsFor(camera, [planned(camera, set)], isByDistance);
        expect(rangeOf(keysOf(set, camera, identity4(), isByDistance))).toBeLessThan(2 ** bits);
      }),
      { numRuns: 500 },
    );
  });

  test('is at most 27 bits for most scenes, less for shallow ones', () => {
    const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 60, aspect: 1 });
    const bitsAt = (halfExtent: number) =>
      keyBitsFor(camera, [planned(camera, randomSplats({ count: 100, shDegree: 0, halfExtent }))], false);
    expect(bitsAt(1e-5)).toBe(16);
    expect(bitsAt(0.5)).toBe(24);
    expect(bitsAt(100)).toBe(27);
    const wide = { ...camera, near: 1e-9 };
    const large = planned(wide, randomSplats({ count: 100, shDegree: 0, halfExtent: 100 }));
    expect(keyBitsFor(wide, [large], false)).toBe(32);
  });

  test('spans the depths of all clouds and ignores empty ones', () => {
    const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 60, aspect: 1 });
    const small = randomSplats({ count: 10, shDegree: 0, halfExtent: 1e-5 });
    const behind = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -90, 1);
    expect(keyBitsFor(camera, [planned(camera, small)], false)).toBe(16);
    expect(keyBitsFor(camera, [planned(camera, small), planned(camera, small, behind)], false)).toBe(27);
    const empty = planned(camera, randomSplats({ count: 0, shDegree: 0 }));
    expect(keyBitsFor(camera, [planned(camera, small), empty, planned(camera, small, behind)], false)).toBe(
      27,
    );
    expect(keyBitsFor(camera, [empty], false)).toBe(16);
    expect(keyBitsFor(camera, [], false)).toBe(16);
  });

  test('spans distances beyond the far plane, to the corners of what is wide and shallow', () => {
    const camera = perspectiveCamera({
      ...{ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 60, aspect: 1 },
      ...{ near: 1, far: 4 },
    });
    // A wall, 30 times as wide as it is away.
    const wide = Float64Array.of(100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 0.01, 0, 0, 0, 0, 1);
    const clouds = [planned(camera, randomSplats({ count: 100, shDegree: 0, halfExtent: 1 }), wide)];
    expect(keyBitsFor(camera, clouds, false)).toBe(24);
    expect(keyBitsFor(camera, clouds, true)).toBe(27);
  });
});

describe('wideKeysFor', () => {
  /** Upper words of the splats that float32 keeps between near and far. */
  function highWordsOf(set: SplatSet, camera: Camera, modelMatrix: Mat4, isByDistance: boolean): number[] {
    const { linear, translation } = cloudView(camera.viewMatrix, modelMatrix, set.origin, false);
    return Array.from({ length: set.count }, (_, i) => {
      const terms = [0, 1, 2].map((row) => [
        linear[row] * set.positions[3 * i],
        linear[row + 3] * set.positions[3 * i + 1],
        linear[row + 6] * set.positions[3 * i + 2],
        translation[row],
      ]);
      const [x, y, z] = terms.map((list) => list.reduce((sum, term) => sum + term));
      const rounding = 6 * 2 ** -24 * terms[2].reduce((sum, term) => sum + Math.abs(term), 0);
      return { depth: -z, rounding, key: isByDistance ? x * x + y * y + z * z : -z };
    })
      .filter(({ depth, rounding }) => depth > camera.near - rounding && depth <= camera.far + rounding)
      .map(({ key }) => orderedWords(key).high);
  }

  /**
   * @fault Order: float32 keeps a splat just beyond near or far
   * @consequence its key stays within the keys' bits
   */
  test('bounds the upper words of any splats that may be kept, and the farthest of them', () => {
    const coordinate = uniform(-50, 50);
    const scene = fc.record({
      seed: fc.nat(),
      halfExtent: fc.constantFrom(1e-4, 0.01, 1, 30),
      origin: fc.oneof(fc.constant([0, 0, 0] as const), fc.tuple(coordinate, coordinate, coordinate)),
    });
    fc.assert(
      fc.property(anyCamera, anyModel, scene, fc.boolean(), (camera, modelMatrix, options, isByDistance) => {
        const set = randomSplats({ count: 50, shDegree: 0, ...options });
        const { bits, farthestHigh } = wideKeysFor(camera, [planned(camera, set, modelMatrix)], isByDistance);
        for (const high of highWordsOf(set, camera, modelMatrix, isByDistance)) {
          expect(high).toBeLessThanOrEqual(farthestHigh);
          expect(farthestHigh - high).toBeLessThan(2 ** (bits - 32));
        }
      }),
      { numRuns: 500 },
    );
  });

  test('is 56 bits for depths within a factor of 2^15, and 64 either side of the eye', () => {
    const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 60, aspect: 1 });
    const clouds = [planned(camera, randomSplats({ count: 100, shDegree: 0, halfExtent: 100 }))];
    expect(wideKeysFor({ near: 0.01, far: 300 }, clouds, false).bits).toBe(56);
    expect(wideKeysFor({ near: 0.01, far: 300 }, clouds, true).bits).toBe(64);
    expect(wideKeysFor({ near: -10, far: 10 }, clouds, false).bits).toBe(64);
    expect(wideKeysFor({ near: 0.01, far: 300 }, [], false)).toEqual({
      bits: 56,
      farthestHigh: expect.any(Number),
    });
  });
});
