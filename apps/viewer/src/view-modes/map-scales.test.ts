import { describe, expect, it } from 'vitest';
import type { MapFigures } from '../state/view-mode.ts';
import {
  contributionNotes,
  contributionScale,
  costScale,
  logPart,
  pixelNotes,
  tileNotes,
} from './map-scales.ts';

const COST: MapFigures = {
  mode: 'tile-cost',
  restedFrames: 1,
  kind: 'cost',
  rasterizer: 'tiles',
  max: 4321,
  mean: 99.7,
  end: 2000,
  blendedPart: 0.6,
};
const QUADS: MapFigures = { ...COST, rasterizer: 'quads' };
const CONTRIBUTION: MapFigures = {
  mode: 'contribution',
  restedFrames: 1,
  kind: 'contribution',
  splats: 5000,
  unseen: 1250,
};
const FAILURE: MapFigures = { mode: 'tile-cost', restedFrames: 1, kind: 'failure', message: 'Too many.' };

describe('maps of costs', () => {
  it('have a scale of whole numbers, which says where there are higher ones', () => {
    const texts = (figures: MapFigures) => costScale('Title', figures)?.ticks.map(({ text }) => text);
    expect(texts(COST)).toEqual(['0', '500', '1,000', '1,500', '≥ 2,000']);
    expect(texts({ ...COST, max: 2000 })?.at(-1)).toBe('2,000');
  });

  it('tell maximum and mean, and what they mean for the rasteriser that draws', () => {
    expect(tileNotes(COST)).toEqual(['At most 4,321, 100 on average in a list.']);
    expect(tileNotes(QUADS)[1]).toContain('no lists');
    expect(pixelNotes(COST)[0]).toContain('60 % of them are blended');
    expect(pixelNotes(QUADS)[0]).toContain('all of them blended');
  });
});

describe('maps of contributions', () => {
  it('have a scale of powers of two', () => {
    expect(contributionScale(CONTRIBUTION)?.ticks.map(({ text }) => text)).toEqual([
      '≤ 1/256',
      '1/8',
      '4',
      '128',
      '≥ 4,096',
    ]);
    expect([-8, 2, 12].map(logPart)).toEqual([0, 0.5, 1]);
  });

  it('tell how many splats are not seen', () => {
    expect(contributionNotes(CONTRIBUTION)[0]).toMatch(/^1,250 of 5,000 splats .*\(25 %\).*blue/);
    const few: MapFigures = { ...CONTRIBUTION, unseen: 1 };
    expect(contributionNotes(few)[0]).toContain('(< 1 %)');
    const none: MapFigures = { ...CONTRIBUTION, splats: 0, unseen: 0 };
    expect(contributionNotes(none)).toEqual(['There are no splats in the picture.']);
  });
});

it('tell nothing of a map that could not be made', () => {
  expect(costScale('Title', FAILURE)).toBeNull();
  expect(contributionScale(FAILURE)).toBeNull();
  for (const notes of [tileNotes, pixelNotes, contributionNotes]) expect(notes(FAILURE)).toEqual([]);
});
