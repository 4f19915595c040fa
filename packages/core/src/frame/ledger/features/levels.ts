import { detailOf } from '../../level-cut.ts';
import type { DrawnCloud, FeatureOfCloud } from '../automatic-feature.ts';

/** Blobs instead of splats that are too small to tell apart. */
export const levels: FeatureOfCloud = {
  of: 'cloud',
  name: 'levels',
  label: 'Levels of detail',
  about: 'Draws blobs that stand for several splats, where these are too small to tell apart.',
  stages: [
    'cut-cells',
    'cut-count',
    'plan-cut',
    'cull-chunks',
    'cut-splats',
    'cull-splats',
    'project',
    'tile-count',
    'tile-emit',
    'tile-masks',
    'tile-rasterize',
    'rasterize',
  ],
  calledFor: ({ plan, shape }) => {
    const { detail = 'full' } = plan.request;
    if (!shape.levels || detail === 'full') return null;
    const { maxErrorPx, maxSplats } = detail;
    if (plan.budget) return `at most ${maxSplats!.toLocaleString('en')} splats are asked for`;
    return `errors up to ${maxErrorPx} px are allowed`;
  },
  offReason,
};

function offReason({ plan, cloud }: DrawnCloud): string {
  const { detail = 'full' } = plan.request;
  if (detail !== 'full' && detailOf(plan.request) === 'full')
    return detail.maxSplats === undefined ? 'no error is allowed' : 'all splats are within the budget';
  return cloud.inFull ?? 'they are being made';
}
