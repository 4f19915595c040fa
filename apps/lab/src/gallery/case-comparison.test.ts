import { describe, expect, it } from 'vitest';
import { DIFFERENCE_COLORS, differenceOf } from './case-comparison.tsx';

describe('the difference of a case’s images', () => {
  it('is the darkest colour everywhere for equal images', () => {
    const image = [0.1, 0.2, 0.3, 1, 0, 0, 0, 0];
    const { pixels, fullSteps, maxSteps } = differenceOf(image, image);
    expect([fullSteps, maxSteps]).toEqual([0, 0]);
    expect([...pixels.slice(0, 4)]).toEqual([...DIFFERENCE_COLORS[0], 255]);
  });

  it('is amplified up to a round number of steps, which the lightest colour stands for', () => {
    const step = 1 / 255;
    const { pixels, fullSteps, maxSteps } = differenceOf(
      [0, 0.002 * step, 0, 1, 0, 0, 0, 0],
      new Array(8).fill(0),
    );
    expect(maxSteps).toBeCloseTo(0.002, 12);
    expect(fullSteps).toBe(0.002);
    expect([...pixels]).toEqual([...DIFFERENCE_COLORS.at(-1)!, 255, ...DIFFERENCE_COLORS[0], 255]);
  });

  it('ignores opacity and what no screen can show, as the bounds do', () => {
    expect(differenceOf([2, -1, 0, 1, 0, 0, 0, 1], [1, 0, 0, 0.5, 0, 0, 0, 0]).maxSteps).toBe(0);
  });
});
