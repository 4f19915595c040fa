import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { apportion, DiscSurface, SurfacePoint, sampleLattice, TurnedSurface } from './surface-sampling.ts';

describe('apportion', () => {
  it('adds up exactly and gives every part its minimum', () => {
    fc.assert(
      fc.property(
        fc.array(fc.double({ min: 0.001, max: 1000, noNaN: true }), { minLength: 1, maxLength: 40 }),
        fc.integer({ min: 1_000, max: 1_000_000 }),
        (weights, total) => {
          const counts = apportion(total, weights, 6);
          expect(counts.reduce((a, b) => a + b, 0)).toBe(total);
          expect(Math.min(...counts)).toBeGreaterThanOrEqual(6);
        },
      ),
    );
  });
});

describe('TurnedSurface', () => {
  const radius = 0.5;
  const points = 25;
  const sphere = new TurnedSurface(
    Array.from({ length: points }, (_, i) => {
      const angle = Math.PI * (i / (points - 1) - 0.5);
      return [Math.max(0, radius * Math.cos(angle)), radius * Math.sin(angle)] as const;
    }),
  );

  it("has a sphere's area, radius and outward normals", () => {
    expect(sphere.area).toBeCloseTo(4 * Math.PI * radius ** 2, 2);
    const point = new SurfacePoint();
    for (let i = 0; i < 500; i++) {
      sampleLattice(sphere, i, 500, point);
      expect(Math.hypot(point.x, point.y, point.z)).toBeCloseTo(radius, 2);
      const outwards = (point.x * point.normalX + point.y * point.normalY + point.z * point.normalZ) / radius;
      expect(outwards).toBeGreaterThan(0.98);
    }
  });
});

describe('sampleLattice', () => {
  it('leaves no gap wider than the spacing allows', () => {
    const disc = new DiscSurface(1);
    const count = 800;
    const points = Array.from({ length: count }, (_, i) => {
      const point = new SurfacePoint();
      sampleLattice(disc, i, count, point);
      return point;
    });
    const { spacing } = points[0];
    for (let probe = 0; probe < 300; probe++) {
      const angle = probe * 2.4;
      const radius = 0.95 * Math.sqrt(probe / 300);
      const x = radius * Math.cos(angle);
      const z = radius * Math.sin(angle);
      const nearest = Math.min(...points.map((point) => Math.hypot(point.x - x, point.z - z)));
      expect(nearest).toBeLessThan(spacing);
    }
  });
});
