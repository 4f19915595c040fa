import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { DILATION_PX2 } from '../accuracy/accuracy.ts';
import { type Camera, perspectiveCamera, projectionOf } from '../camera/camera.ts';
import { cloudView } from '../camera/cloud-view.ts';
import { frustumSides } from '../camera/frustum.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { identity4 } from '../math/mat4.ts';
import { packCloud } from '../packing/packed-cloud.ts';
import { cullSplat } from '../reference/cull-splats.ts';
import { anyCamera } from '../testing/any-view.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { TEST_MODELS } from '../testing/test-cameras.ts';
import { visibleCapacity } from './visible-capacity.ts';

const ALPHA_CUTOFF = 1 / 255;
const SIZE = { widthPx: 64, heightPx: 48 };
const CAMERA = perspectiveCamera({ position: [0, 0, 0], target: [0, 0, 1], fovYDegrees: 50, aspect: 1.3 });

/** More splats than there is always room for; small ones, so that most chunks are clearly in or out. */
const set = randomSplats({ count: 270_000, shDegree: 0, logScales: [-9, -7] });
const cloud = packCloud(set, { geometryPrecision: 'packed' }) as unknown as SplatCloud;

const cloudsOf = (camera: Camera, modelMatrix: ArrayLike<number> = identity4()) => {
  const projection = projectionOf(camera, SIZE.widthPx, SIZE.heightPx);
  const view = cloudView(camera.viewMatrix, modelMatrix, set.origin, projection.isOrthographic);
  return [{ instance: { cloud }, sides: frustumSides(view, projection, ALPHA_CUTOFF, DILATION_PX2) }];
};

describe('visibleCapacity', () => {
  test('suffices for all splats that are drawn', () => {
    fc.assert(
      fc.property(anyCamera, fc.constantFrom(...Object.values(TEST_MODELS)), (camera, modelMatrix) => {
        const projection = projectionOf(camera, SIZE.widthPx, SIZE.heightPx);
        const view = cloudView(camera.viewMatrix, modelMatrix, set.origin, projection.isOrthographic);
        let drawn = 0;
        for (let i = 0; i < set.count; i++) {
          const settings = { alphaCutoff: ALPHA_CUTOFF, dilationPx2: DILATION_PX2 };
          if (cullSplat(set, i, view, projection, settings)) drawn++;
        }
        expect(visibleCapacity(cloudsOf(camera, modelMatrix), 0)).toBeGreaterThanOrEqual(drawn);
      }),
      { numRuns: 5, seed: 1 },
    );
  });

  test('is a whole number of chunks, less than all splats if few are in sight, and never more than all', () => {
    const capacity = visibleCapacity(cloudsOf(CAMERA), 0);
    expect(capacity).toBeLessThan(set.count / 2);
    expect(capacity % 256).toBe(0);
    const away = perspectiveCamera({ position: [0, 0, 9], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
    expect(visibleCapacity(cloudsOf(away), 0)).toBe(set.count);
  });

  test('keeps the current room if it suffices, and grows if not', () => {
    const needed = visibleCapacity(cloudsOf(CAMERA), 0);
    expect(visibleCapacity(cloudsOf(CAMERA), needed)).toBe(needed);
    expect(visibleCapacity(cloudsOf(CAMERA), needed + 5)).toBe(needed + 5);
    expect(visibleCapacity(cloudsOf(CAMERA), 256)).toBe(needed);
    expect(visibleCapacity(cloudsOf(CAMERA), set.count)).toBe(set.count);
  });

  test('is all splats for small scenes', () => {
    const small = packCloud(randomSplats({ count: 1000, shDegree: 0 }), { geometryPrecision: 'packed' });
    const [planned] = cloudsOf(CAMERA);
    const clouds = [{ ...planned, instance: { cloud: small as unknown as SplatCloud } }];
    expect(visibleCapacity(clouds, 0)).toBe(1000);
    expect(visibleCapacity([], 0)).toBe(0);
  });
});
