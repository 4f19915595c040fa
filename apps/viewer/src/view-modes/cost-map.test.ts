import type { FrameContributions, FrameCosts } from '@websplatter/core/inspect';
import { describe, expect, it } from 'vitest';
import type { LayerImage } from '../state/frames.ts';
import { contributionImage, countFigures, pixelImage, tileImage } from './cost-map.ts';
import { UNSEEN_COLOR, VALUE_RAMP } from './ramp.ts';

const { low, high } = VALUE_RAMP;
const colorAt = ({ data, widthPx }: LayerImage, x: number, y: number) =>
  Array.from(data.subarray(4 * (y * widthPx + x), 4 * (y * widthPx + x) + 4));

const COSTS: FrameCosts = {
  widthPx: 10,
  heightPx: 9,
  steps: Uint32Array.from({ length: 90 }, (_, i) => i),
  blended: new Uint32Array(90),
  fragments: new Uint32Array(90),
  tileEntries: Uint32Array.of(0, 40, 20, 80),
  tileColumns: 2,
  tilePx: 8,
};

describe('figures of counts', () => {
  it('have the maximum, the mean and an end of the scale that is easily read', () => {
    expect(countFigures(Uint32Array.of(1, 2, 6))).toEqual({ max: 6, mean: 3, end: 8 });
    expect(countFigures(new Uint32Array(0))).toEqual({ max: 0, mean: 0, end: 4 });
    for (const [most, end] of [
      [0, 4],
      [4, 4],
      [37, 40],
      [118, 120],
      [412, 500],
      [5000, 5000],
      [5001, 6000],
    ])
      expect(countFigures(Uint32Array.of(most)).end, String(most)).toBe(end);
  });

  it('leave the highest hundredth beyond the end, which would take most of the scale', () => {
    const counts = new Uint32Array(300).fill(7);
    counts[0] = counts[1] = counts[2] = 10_000;
    expect(countFigures(counts)).toMatchObject({ max: 10_000, end: 8 });
    counts[3] = 10_000;
    expect(countFigures(counts).end).toBe(10_000);
  });
});

describe('maps of the costs of a frame', () => {
  it('show the list of each tile between darker lines', () => {
    const image = tileImage(COSTS, 40);
    expect(image).toMatchObject({ widthPx: 10, heightPx: 9 });
    expect(colorAt(image, 1, 1)).toEqual([...low.color, 255]);
    expect(colorAt(image, 9, 7)).toEqual([...high.color, 255]);
    const line = colorAt(image, 8, 7);
    expect(line[0]).toBeCloseTo(0.7 * high.color[0], -1);
    // More than the scale tells.
    expect(image.data.every((value) => value <= 255)).toBe(true);
    expect(colorAt(image, 3, 8)[0]).toBeCloseTo((0.7 * (low.color[0] + high.color[0])) / 2, -1);
  });

  it('show the count of each pixel', () => {
    const image = pixelImage(COSTS, COSTS.steps, 44);
    expect(colorAt(image, 0, 0)).toEqual([...low.color, 255]);
    expect(colorAt(image, 4, 4)).toEqual([...high.color, 255]);
    expect(colorAt(image, 9, 8)).toEqual([...high.color, 255]);
  });
});

describe('the map of contributions', () => {
  it('blends the colours of contributions over the background, and the places of unseen splats over these', () => {
    const map: FrameContributions = {
      widthPx: 5,
      heightPx: 1,
      meanLog2: Float32Array.of(-8, 13, 12, -8, -8),
      opacity: Float32Array.of(1, 1, 0.5, 0, 0),
      unseen: Uint32Array.of(0, 0, 0, 0, 40),
      contributionsPx: Float32Array.of(),
    };
    const image = contributionImage(map, [0, 0.2, 1]);
    expect(colorAt(image, 0, 0)).toEqual([...low.color, 255]);
    expect(colorAt(image, 1, 0)).toEqual([...high.color, 255]);
    const half = colorAt(image, 2, 0);
    expect(half[1]).toBeCloseTo((high.color[1] + 51) / 2, -1);
    expect(half[2]).toBeCloseTo((high.color[2] + 255) / 2, -1);
    // Its pixel and the one beside it, but none in another row or farther away.
    expect(colorAt(image, 3, 0)).toEqual([...UNSEEN_COLOR.color, 255]);
    expect(colorAt(image, 4, 0)).toEqual([...UNSEEN_COLOR.color, 255]);
  });
});
