import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { perspectiveCamera } from '../camera/camera.ts';
import { cloudView } from '../camera/cloud-view.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { orderedBits } from '../layout/depth-key.ts';
import { identity4, type Mat4 } from '../math/mat4.ts';
import { packCloud } from '../packing/packed-cloud.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { anyCamera, anyModel } from '../testing/any-view.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { uniform } from '../testing/uniform.ts';
import { keyBitsFor } from './key-bits.ts';

function planned(set: SplatSet, modelMatrix: Mat4 = identity4()) {
  const cloud = packCloud(set, { geometryPrecision: 'f32' }) as unknown as SplatCloud;
  return { instance: { cloud, modelMatrix }, modelMatrix, reach: { displacement: 0, growth: 1 } };
}

/** Depths in float32, rounded after every operation, as on a GPU that fuses none. */
function depthsOf(set: SplatSet, viewMatrix: ArrayLike<number>, modelMatrix: ArrayLike<number>): number[] {
  const f = Math.fround;
  const { linear, translation } = cloudView(viewMatrix, modelMatrix, set.origin, false);
  return Array.from({ length: set.count }, (_, i) => {
    let depth = f(f(linear[2]) * set.positions[3 * i]);
    depth = f(depth + f(f(linear[5]) * set.positions[3 * i + 1]));
    depth = f(depth + f(f(linear[8]) * set.positions[3 * i + 2]));
    return -f(depth + f(translation[2]));
  });
}

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
      fc.property(anyCamera, anyModel, scene, (camera, modelMatrix, options) => {
        const set = randomSplats({ count: 50, shDegree: 0, ...options });
        const bits = keyBitsFor(camera, [planned(set, modelMatrix)]);
        const keys = depthsOf(set, camera.viewMatrix, modelMatrix)
          .filter((depth) => depth > Math.fround(camera.near) && depth <= Math.fround(camera.far))
          .map(orderedBits);
        if (keys.length > 0) expect(Math.max(...keys) - Math.min(...keys)).toBeLessThan(2 ** bits);
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
      fc.property(direction, distance, fc.nat(), (d, far, seed) => {
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
        const keys = depthsOf(set, camera.viewMatrix, identity4())
          .filter((depth) => depth > Math.fround(camera.near))
          .map(orderedBits);
        const bits = keyBitsFor(camera, [planned(set)]);
        if (keys.length > 0) expect(Math.max(...keys) - Math.min(...keys)).toBeLessThan(2 ** bits);
      }),
      { numRuns: 500 },
    );
  });

  test('is at most 27 bits for most scenes, less for shallow ones', () => {
    const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 60, aspect: 1 });
    const bitsAt = (halfExtent: number) =>
      keyBitsFor(camera, [planned(randomSplats({ count: 100, shDegree: 0, halfExtent }))]);
    expect(bitsAt(1e-5)).toBe(16);
    expect(bitsAt(0.5)).toBe(24);
    expect(bitsAt(100)).toBe(27);
    const wide = { ...camera, near: 1e-9 };
    expect(keyBitsFor(wide, [planned(randomSplats({ count: 100, shDegree: 0, halfExtent: 100 }))])).toBe(32);
  });

  test('spans the depths of all clouds and ignores empty ones', () => {
    const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 60, aspect: 1 });
    const small = randomSplats({ count: 10, shDegree: 0, halfExtent: 1e-5 });
    const behind = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -90, 1);
    expect(keyBitsFor(camera, [planned(small)])).toBe(16);
    expect(keyBitsFor(camera, [planned(small), planned(small, behind)])).toBe(27);
    const empty = planned(randomSplats({ count: 0, shDegree: 0 }));
    expect(keyBitsFor(camera, [planned(small), empty, planned(small, behind)])).toBe(27);
    expect(keyBitsFor(camera, [empty])).toBe(16);
    expect(keyBitsFor(camera, [])).toBe(16);
  });
});
