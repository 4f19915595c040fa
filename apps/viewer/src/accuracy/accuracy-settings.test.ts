import { describe, expect, it } from 'vitest';
import { detailStateOf, positionOf, SLIDER_STEPS, valueAt } from './accuracy-settings.tsx';

describe('setting slider', () => {
  it.each([
    [1 / 4096, 0.1],
    [0.25, 1],
    [100, 10_000],
    [60_000, 6_000_000],
  ])('moves a slider through %d…%d and back', (min, max) => {
    const range = { min, max };
    expect(valueAt(0, range)).toBe(min);
    expect(valueAt(SLIDER_STEPS, range)).toBe(max);
    for (let position = 0; position < SLIDER_STEPS; position++) {
      expect(positionOf(valueAt(position, range), range)).toBe(position);
      expect(valueAt(position + 1, range)).toBeGreaterThan(valueAt(position, range));
    }
  });
});

it('detail is always in one of its states, on slow devices too', () => {
  const inMotion = { maxFrameMs: 50 };
  expect(detailStateOf('full', 'full')).toBe('full');
  expect(detailStateOf('full', inMotion)).toBe('auto');
  expect(detailStateOf('auto', 'auto')).toBe('auto');
  for (const detail of [{ maxSplats: 3100 }, { minPsnrDb: 45 }, { maxErrorPx: 1 }])
    expect(detailStateOf(detail, detail)).toBe('limited');
});
