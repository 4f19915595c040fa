import { expect, test } from 'vitest';
import { DETAIL_SHARES, describeDetail } from './details.ts';

test('details have names that people read', () => {
  expect(DETAIL_SHARES.map((maxShare) => describeDetail({ maxShare }))).toEqual(
    DETAIL_SHARES.map((share) => `${Math.round(100 * share)} % of splats`),
  );
  expect(describeDetail({ maxErrorPx: 0.5, maxSplats: 4000 })).toBe('0.5 px of error, 4,000 splats');
  expect(describeDetail('full')).toBe('full detail');
});
