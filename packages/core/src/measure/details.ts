import { type FixedDetail, percentText } from '../frame/plan/detail.ts';

/** Default shares of the splats in sight to measure, 0…1. */
export const DETAIL_SHARES: readonly number[] = [0.7, 0.5, 0.25, 0.12, 0.06];

/** Describes a detail for people: `50 % of splats`. */
export function describeDetail(detail: FixedDetail): string {
  if (detail === 'full') return 'full detail';
  const { maxErrorPx, maxSplats, maxShare } = detail;
  return [
    ...(maxErrorPx === undefined ? [] : [`${maxErrorPx} px of error`]),
    ...(maxSplats === undefined ? [] : [`${maxSplats.toLocaleString('en')} splats`]),
    ...(maxShare === undefined ? [] : [`${percentText(maxShare)} of splats`]),
  ].join(', ');
}
