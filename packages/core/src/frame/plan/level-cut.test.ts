import { describe, expect, test } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { DILATION_PX2 } from '../../data/accuracy/accuracy.ts';
import { perspectiveCamera, projectionOf } from '../../data/camera/camera.ts';
import { cloudView } from '../../data/camera/cloud-view.ts';
import { frustumSides } from '../../data/camera/frustum.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { identity4 } from '../../data/math/mat4.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { cutBudget, type LevelCut, neededDetail } from './level-cut.ts';

const COUNT = 4096;
const set = randomSplats({ count: COUNT, shDegree: 0, logScales: [-9, -7] });
const cloud = { ...packCloud(set, { geometryPrecision: 'packed' }), features: [] } as unknown as SplatCloud;
const CUT: LevelCut = { camera: [0, 0, 0], squaredPerDistance: 1, leastSquared: 0, margin: 0 };

/** A cloud that lies before the camera, or behind it. */
function seen(isBefore: boolean, cut: LevelCut | null) {
  const position = [0, 0, 50] as const;
  const target = [0, 0, isBefore ? 0 : 100] as const;
  const camera = perspectiveCamera({ position, target, fovYDegrees: 60, aspect: 1 });
  const projection = projectionOf(camera, 64, 64);
  const view = cloudView(camera.viewMatrix, identity4(), set.origin, false);
  return { instance: { cloud }, sides: frustumSides(view, projection, 1 / 255, DILATION_PX2), cut };
}

describe('a budget', () => {
  test('is a number, or a share of the splats in sight, whichever is less', () => {
    const clouds = [seen(true, CUT), seen(false, CUT)];
    expect(cutBudget({ maxSplats: 1000 }, clouds)).toEqual({ splats: 1000, leastShift: 0 });
    expect(cutBudget({ maxShare: 0.25 }, clouds)).toEqual({ splats: COUNT / 4, leastShift: 0 });
    expect(cutBudget({ maxShare: 0.25, maxSplats: 100 }, clouds)?.splats).toBe(100);
    expect(cutBudget({ maxErrorPx: 1, maxShare: 0.5 }, clouds)?.leastShift).toBe(LEVEL_CONSTANTS.SHIFT_NONE);
    expect(cutBudget({ maxSplats: 2 * COUNT }, clouds)).toBeNull();
    expect(cutBudget({ maxErrorPx: 1 }, clouds)).toBeNull();
  });

  test('has no room for clouds in full that are in sight, and loses nothing to others', () => {
    expect(cutBudget({ maxSplats: 5000 }, [seen(true, CUT), seen(true, null)])?.splats).toBe(5000 - COUNT);
    expect(cutBudget({ maxSplats: 1000 }, [seen(true, CUT), seen(true, null)])?.splats).toBe(0);
    expect(cutBudget({ maxSplats: 1000 }, [seen(true, CUT), seen(false, null)])?.splats).toBe(1000);
    expect(cutBudget({ maxShare: 0.5 }, [seen(true, null)])).toBeNull();
  });
});

test('limits that limit nothing are full detail', () => {
  const clouds = [{ cloud }];
  expect(neededDetail({ maxErrorPx: 0 }, clouds)).toBe('full');
  expect(neededDetail({ maxSplats: COUNT, maxShare: 1 }, clouds)).toBe('full');
  expect(neededDetail({ maxErrorPx: 0, maxSplats: 9 }, clouds)).toEqual({ maxSplats: 9 });
  expect(neededDetail({ maxErrorPx: 2, maxShare: 1 }, clouds)).toEqual({ maxErrorPx: 2, maxShare: 1 });
});
