import { expect, it } from 'vitest';
import { type Inspecting, NOTHING_INSPECTED, withoutSplats } from './inspecting.ts';

it('keeps distances and the crop where files of the scene have changed, and forgets what was told of splats', () => {
  const crop = { min: [0, 0, 0], max: [1, 1, 1], keep: 'inside' } as const;
  const before: Inspecting = {
    ...NOTHING_INSPECTED,
    tab: 'crop',
    splat: { cloudIndex: 1, row: 7, share: null, set: null, seen: null },
    rulerStart: [1, 2, 3],
    crop,
    cropCount: 1,
  };
  const after = withoutSplats(before);
  expect(after).toEqual({ ...NOTHING_INSPECTED, tab: 'crop', rulerStart: [1, 2, 3], crop });
  // Nothing to forget means no change.
  expect(withoutSplats(after)).toBe(after);
  expect(withoutSplats(NOTHING_INSPECTED)).toBe(NOTHING_INSPECTED);
});
