import { planeNormal, type VolumeValues } from '@websplatter/core/effect-options';
import { describe, expect, it } from 'vitest';
import { firstValues } from '../state/effect-values.ts';
import { dot, subtract, type Vec3 } from '../state/vec3.ts';
import { volumeOutline } from './volume-gizmo.tsx';

const center: Vec3 = [1, 2, 3];
const first = {
  ...firstValues('volumes', { center, radius: 2, viewDepth: 5 }),
  center,
} as VolumeValues;

describe('the outline of a volume', () => {
  it('has the twelve edges of a box', () => {
    const size: Vec3 = [2, 4, 6];
    const lines = volumeOutline({ ...first, shape: 'box', size }, 1);
    expect(lines.reduce((sum, points) => sum + points.length - 1, 0)).toBe(12);
    for (const point of lines.flat())
      expect(subtract(point, center).map((value, axis) => Math.abs(value) / size[axis])).toEqual([
        0.5, 0.5, 0.5,
      ]);
  });

  it('lies on the sphere', () => {
    for (const point of volumeOutline({ ...first, shape: 'sphere', radius: 0.5 }, 1).flat())
      expect(Math.hypot(...subtract(point, center))).toBeCloseTo(0.5, 12);
  });

  it.each([
    [0, -90],
    [30, 0],
    [-120, 55],
  ])(
    'lies in the plane that is turned by %d° and tilted by %d°, and points to what stays',
    (turnDegrees, tiltDegrees) => {
      const choice = { ...first, shape: 'plane', turnDegrees, tiltDegrees } as const;
      const normal = planeNormal(choice);
      const [square, arrow] = volumeOutline(choice, 3);
      for (const point of square) {
        expect(dot(subtract(point, center), normal)).toBeCloseTo(0, 12);
        expect(Math.hypot(...subtract(point, center))).toBeCloseTo(3 * Math.SQRT2, 12);
      }
      expect(dot(subtract(arrow[1], center), normal)).toBeCloseTo(1, 12);
      const [, away] = volumeOutline({ ...choice, mode: 'hide' }, 3);
      expect(dot(subtract(away[1], center), normal)).toBeCloseTo(-1, 12);
    },
  );
});
