import { cameraPosition, type SplatCloud } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { type BenchPathScene, benchCameras } from './bench-path.ts';

const BOUNDS = { min: [-1, -1, -1], max: [1, 1, 1] } as const;
const cloud = { count: 1, bounds: BOUNDS, robustBounds: BOUNDS } as unknown as SplatCloud;
const SCENE: BenchPathScene = {
  clouds: [{ cloud }],
  firstView: null,
  ownCameras: null,
  isUpsideDown: false,
  isZUp: false,
};
const REQUEST = { widthPx: 64, heightPx: 32, frames: 4, sweepDegrees: 20 };

describe('the path of a benchmark', () => {
  it('has a camera for each frame, follows from scene and request alone, and keeps its distance from the scene', () => {
    const cameras = benchCameras(SCENE, REQUEST);
    expect(cameras).toHaveLength(4);
    expect(benchCameras(SCENE, REQUEST)).toEqual(cameras);
    const distances = cameras.map(({ viewMatrix }) => Math.hypot(...cameraPosition(viewMatrix)));
    expect(Math.min(...distances)).toBeGreaterThan(Math.sqrt(3));
    expect(Math.max(...distances) / Math.min(...distances)).toBeCloseTo(1, 6);
    // Width by height.
    expect(cameras[0].projectionMatrix[5] / cameras[0].projectionMatrix[0]).toBeCloseTo(2, 12);
  });

  it('stands upside down where the scene does, and upright along its z axis', () => {
    const above = (changes: Partial<BenchPathScene>, axis: number) =>
      cameraPosition(benchCameras({ ...SCENE, ...changes }, REQUEST)[2].viewMatrix)[axis];
    expect(above({}, 1)).toBeGreaterThan(0);
    expect(above({ isUpsideDown: true }, 1)).toBeLessThan(0);
    expect(above({ isUpsideDown: true, isZUp: true }, 2)).toBeGreaterThan(0);
  });

  it('begins where a scene begins, and at the first of its own cameras', () => {
    const firstView = {
      position: [0, 0, 9],
      target: [0, 0, 0],
      up: [0, 1, 0],
      fovYDegrees: 40,
      near: 0.1,
      far: 20,
    } as const;
    // The middle one of four.
    const seen = benchCameras({ ...SCENE, firstView }, REQUEST)[2];
    expect(cameraPosition(seen.viewMatrix)[2]).toBeCloseTo(9, 9);
    const ownCameras = () => ({ first: seen, second: benchCameras(SCENE, REQUEST)[0] });
    const own = benchCameras({ ...SCENE, firstView, ownCameras }, REQUEST)[2];
    expect(own.projectionMatrix).toEqual(seen.projectionMatrix);
  });
});
