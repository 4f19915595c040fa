import { expect, test } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { DETAIL_SHARES, describeDetail, detailsOfShares } from './details.ts';

const cloudsOf = (...counts: readonly number[]) =>
  counts.map((count) => ({ cloud: { count, checkUsable() {} } as unknown as SplatCloud }));

test('shares of all clouds together become budgets, rounded up', () => {
  expect(detailsOfShares(cloudsOf(700, 301))).toEqual(
    [701, 501, 251, 121, 61].map((maxSplats) => ({ maxSplats })),
  );
  expect(detailsOfShares(cloudsOf(1000), [0.5])).toEqual([{ maxSplats: 500 }]);
});

test('a number of splats is measured once, and there is always one', () => {
  expect(detailsOfShares(cloudsOf(3))).toEqual([{ maxSplats: 3 }, { maxSplats: 2 }, { maxSplats: 1 }]);
  expect(detailsOfShares(cloudsOf(0))).toEqual([{ maxSplats: 1 }]);
});

test.each([0, 1.01, Number.NaN, '0.5'])('a share of %s is refused', (share) => {
  expect(() => detailsOfShares(cloudsOf(3), [share as number])).toThrow(/^shares is .* above 0 and up to 1/);
});

test('details have names that people read', () => {
  const clouds = cloudsOf(300_000, 199_999);
  expect(detailsOfShares(clouds).map((detail) => describeDetail(detail, clouds))).toEqual(
    DETAIL_SHARES.map((share) => `${Math.round(100 * share)} % of splats`),
  );
  expect(describeDetail({ maxErrorPx: 0.5, maxSplats: 4000 }, clouds)).toBe(
    '0.5 px of error, 0.8 % of splats',
  );
  expect(describeDetail({ maxShare: 0.125 }, clouds)).toBe('12.5 % of splats in sight');
  expect(describeDetail('full', clouds)).toBe('full detail');
});
