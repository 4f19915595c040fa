import { describe, expect, it } from 'vitest';
import { FIGURES_BUDGET_MS, LEAST_PAUSE_MS, pauseBetweenWrites } from './hud-binding.ts';

describe('the pace of figures', () => {
  it('is as fast as they can be read where frames are quick', () => {
    expect(pauseBetweenWrites(0.8, 1000 / 60)).toBe(LEAST_PAUSE_MS);
    expect(pauseBetweenWrites(0, 500)).toBe(LEAST_PAUSE_MS);
  });

  it('keeps to the budget of each frame where frames are slow', () => {
    const [writeMs, frameMs] = [0.8, 100];
    const writesPerFrame = frameMs / pauseBetweenWrites(writeMs, frameMs);
    expect(writeMs * writesPerFrame).toBeCloseTo(FIGURES_BUDGET_MS, 6);
  });

  it('never lets them stand still', () => {
    expect(pauseBetweenWrites(50, 5000)).toBe(1000);
  });
});
