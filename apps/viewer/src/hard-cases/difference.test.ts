import { describe, expect, it } from 'vitest';
import { DIFFERENCE_COLORS, differenceOf, pixelsOnBlack, roundAbove } from './difference.ts';

const TWO = { widthPx: 2, heightPx: 1 };

describe('the difference of a case’s images', () => {
  it('is the darkest colour everywhere for equal images', () => {
    const image = [0.1, 0.2, 0.3, 1, 0, 0, 0, 0];
    const { pixels, fullSteps, maxSteps } = differenceOf(image, image, TWO);
    expect([fullSteps, maxSteps]).toEqual([0, 0]);
    expect([...pixels.slice(0, 4)]).toEqual([...DIFFERENCE_COLORS[0], 255]);
  });

  it('is amplified up to a round number of steps, which the lightest colour stands for', () => {
    const step = 1 / 255;
    const { pixels, fullSteps, maxSteps } = differenceOf(
      [0, 0.002 * step, 0, 1, 0, 0, 0, 0],
      new Array(8).fill(0),
      TWO,
    );
    expect(maxSteps).toBeCloseTo(0.002, 12);
    expect(fullSteps).toBe(0.002);
    expect([...pixels]).toEqual([...DIFFERENCE_COLORS.at(-1)!, 255, ...DIFFERENCE_COLORS[0], 255]);
  });

  it('ignores opacity and what no screen can show, as the bounds do', () => {
    expect(differenceOf([2, -1, 0, 1, 0, 0, 0, 1], [1, 0, 0, 0.5, 0, 0, 0, 0], TWO).maxSteps).toBe(0);
  });

  it.each([
    [0, 0],
    [1, 1],
    [1.1, 2],
    [3, 5],
    [6, 10],
    [0.00031, 0.0005],
    [255, 500],
  ])('rounds %d up to %d', (value, round) => {
    expect(roundAbove(value)).toBe(round);
  });

  it('shows images on black', () => {
    expect([...pixelsOnBlack([0.5, 2, -1, 0.2])]).toEqual([128, 255, 0, 255]);
  });
});
