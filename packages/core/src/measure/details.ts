import { checkKind, wrongArgument } from '../data/given.ts';
import type { FixedDetail } from '../frame/detail.ts';
import type { CloudInstance } from '../frame/frame-request.ts';
import { checkClouds } from './check-options.ts';

/** Shares of a scene's splats that are measured where no others are asked for. */
export const DETAIL_SHARES: readonly number[] = [0.7, 0.5, 0.25, 0.12, 0.06];

/**
 * Returns the details, for `measureAccuracy`, by which frames draw at most these shares of the
 * splats of all clouds: each number of splats once.
 *
 * @param shares above 0 and up to 1; default those of `DETAIL_SHARES`.
 * @throws InvalidArgumentError for other shares.
 */
export function detailsOfShares(
  clouds: readonly CloudInstance[],
  shares: readonly number[] = DETAIL_SHARES,
): FixedDetail[] {
  checkClouds(clouds);
  checkKind('shares', shares, 'a list');
  for (const share of shares)
    if (!(Number.isFinite(share) && share > 0 && share <= 1))
      throw wrongArgument('shares', share, 'a number above 0 and up to 1');
  const total = splatsOf(clouds);
  const counts = new Set(shares.map((share) => Math.max(1, Math.ceil(share * total))));
  return [...counts].map((maxSplats) => ({ maxSplats }));
}

/** Describes a detail of these clouds for people: `50 % of splats`. */
export function describeDetail(detail: FixedDetail, clouds: readonly CloudInstance[]): string {
  if (detail === 'full') return 'full detail';
  const { maxErrorPx, maxSplats, maxShare } = detail;
  return [
    ...(maxErrorPx === undefined ? [] : [`${maxErrorPx} px of error`]),
    ...(maxSplats === undefined ? [] : [`${percent(maxSplats / splatsOf(clouds))} of splats`]),
    ...(maxShare === undefined ? [] : [`${percent(maxShare)} of splats in sight`]),
  ].join(', ');
}

function percent(share: number): string {
  return `${Number((100 * share).toPrecision(3))} %`;
}

/** Splats of all clouds, as budgets count them. */
export function splatsOf(clouds: readonly CloudInstance[]): number {
  return clouds.reduce((sum, { cloud }) => sum + cloud.count, 0);
}
