import { verticalFov } from '@websplatter/kit/vertical-fov';
import { describe, expect, it } from 'vitest';
import { lookAt } from '../state/orbit-pose.ts';
import { backgroundOf, poseOf, shorterFov } from './settings-pose.ts';

describe('a camera of SuperSplat', () => {
  it('sees the same side of a file: both turn it by half, around z and around x', () => {
    const { position, target, up } = lookAt(
      poseOf({ position: [1, 2, 3], target: [-1, 0, 1], fovDegrees: 60 }),
    );
    for (const [i, value] of [-1, 2, -3].entries()) expect(position[i]).toBeCloseTo(value);
    for (const [i, value] of [1, 0, -1].entries()) expect(target[i]).toBeCloseTo(value);
    expect(up).toEqual([0, 1, 0]);
  });

  it('sees as much over the longer side of the image', () => {
    const tangent = (degrees: number) => Math.tan((degrees * Math.PI) / 360);
    const wide = verticalFov(shorterFov(70, 16 / 9), 16 / 9);
    expect((16 / 9) * tangent(wide)).toBeCloseTo(tangent(70));
    const tall = verticalFov(shorterFov(70, 9 / 16), 9 / 16);
    expect(tall).toBeCloseTo(70);
  });

  it('has a background as style sheets write it', () => {
    expect(backgroundOf([1, 0.5, 0])).toBe('#ff8000');
    expect(backgroundOf([2, -1, 0.02])).toBe('#ff0005');
  });
});
