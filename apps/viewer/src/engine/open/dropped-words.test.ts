import { describe, expect, it } from 'vitest';
import { droppedReasons, droppedTotal } from './dropped-words.ts';
import { droppedWarning } from './scene-notices.ts';

describe('dropped splats', () => {
  it('says each reason in plain words, the most frequent first', () => {
    const dropped = { 'non-finite-position': 12, 'non-finite-opacity': 400, 'non-finite-scale': 0 };
    expect(droppedReasons(dropped)).toEqual([
      { reason: 'non-finite-opacity', words: 'Opacity is not a number', count: 400 },
      { reason: 'non-finite-position', words: 'Position is not a finite number', count: 12 },
    ]);
    expect(droppedTotal(dropped)).toBe(412);
    expect(droppedReasons({})).toEqual([]);
  });

  it('says nothing up front where less than half was left out', () => {
    expect(droppedWarning('a.ply', 10, {})).toBeNull();
    expect(droppedWarning('a.ply', 201, { 'non-finite-scale': 200 })).toBeNull();
  });

  it.each([
    [200, 200, 'Half of the splats were left out'],
    [199, 201, 'More than half of the splats were left out'],
    [400, 600, '60% of the splats were left out'],
    [1, 99_999, '99% of the splats were left out'],
  ])('of %d kept and %d dropped it says “%s”', (kept, left, title) => {
    expect(droppedWarning('a.ply', kept, { 'non-finite-scale': left })?.title).toBe(title);
  });

  it('names the file and counts its rows', () => {
    expect(droppedWarning('a.ply', 1000, { 'non-finite-scale': 3000 })?.message).toBe(
      '3,000 of the 4,000 rows in a.ply hold values that are not usable numbers. The rest is shown, but the file is probably damaged.',
    );
  });
});
