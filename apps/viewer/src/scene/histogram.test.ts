import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { barHeight, binOf, medianBin, opacityEdges, scaleEdges } from './histogram.ts';

describe('edges of scales', () => {
  it('lie around all values at equal ratios, in at most 40 bins, with a power of ten among those of several decades', () => {
    fc.assert(
      fc.property(
        fc.double({ min: -7, max: 7, noNaN: true }),
        fc.double({ min: 0, max: 8, noNaN: true }),
        (low, decades) => {
          const [least, most] = [10 ** low, 10 ** (low + decades)];
          const edges = scaleEdges(least, most);
          expect(edges.length).toBeGreaterThan(1);
          expect(edges.length).toBeLessThanOrEqual(41);
          expect(edges[0]).toBeLessThanOrEqual(least * (1 + 1e-12));
          expect(edges.at(-1)).toBeGreaterThan(most * (1 - 1e-12));
          const ratio = edges[1] / edges[0];
          for (const [i, edge] of edges.slice(1).entries()) expect(edge / edges[i]).toBeCloseTo(ratio, 9);
        },
      ),
    );
    expect(scaleEdges(0.02, 30)).toContain(1);
  });

  it('reach no more than eight decades below the largest, and stay finite without any extent', () => {
    expect(scaleEdges(1e-30, 1)[0]).toBeCloseTo(1e-8, 12);
    for (const [least, most] of [
      [0, 0],
      [Number.POSITIVE_INFINITY, 0],
      [1, Number.POSITIVE_INFINITY],
    ])
      expect(scaleEdges(least, most)).toEqual([0.1, 1]);
  });
});

describe('the bin of a value', () => {
  it('is the one whose edges are around it', () => {
    const bins = { edges: scaleEdges(0.001, 9), isByRatio: true };
    fc.assert(
      fc.property(fc.double({ min: 0.0011, max: 8.9, noNaN: true }), (value) => {
        const bin = binOf(value, bins);
        expect(bins.edges[bin]).toBeLessThanOrEqual(value * (1 + 1e-9));
        expect(bins.edges[bin + 1]).toBeGreaterThanOrEqual(value * (1 - 1e-9));
      }),
    );
  });

  it('is the last or the first for what is beyond', () => {
    const bins = { edges: opacityEdges(), isByRatio: false };
    expect([binOf(0, bins), binOf(1, bins), binOf(0.51, bins)]).toEqual([0, 19, 10]);
    expect(binOf(0, { edges: [0.1, 1, 10], isByRatio: true })).toBe(0);
  });
});

it('the median is in the bin in which half of all splats have been counted', () => {
  expect(medianBin({ counts: [1, 5, 1] })).toBe(1);
  expect(medianBin({ counts: [9, 1, 1] })).toBe(0);
});

it('bars show a single splat beside a million, and none as nothing', () => {
  expect([barHeight(0, 1e6), barHeight(1e6, 1e6)]).toEqual([0, 1]);
  expect(barHeight(1, 1e6)).toBeGreaterThan(0.04);
});
