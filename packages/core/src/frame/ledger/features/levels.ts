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

function offReason({ plan, shape, cloud }: DrawnCloud): string {
  if ((plan.request.detail ?? 'full') === 'full') return 'full detail is asked for';
  if (detailOf(plan.request) === 'full') return 'all splats are within the budget';
  if (shape.cloud.isPreview) return 'the cloud is loading';
  if (shape.cloud.count === 0) return 'the cloud has no splats';
  if (shape.cloud.editing) return 'the cloud was edited';
  if (shape.cloud.levelsLack) return shape.cloud.levelsLack.message;
  if (!shape.cloud.levels) return 'they are being made';
  if (plan.shape.accuracy.recordPrecision === 'paper') return 'records of 24 bytes hold no opacity above 1';
  return cloud.view.inverse ? 'an effect shows a selection of splats' : 'the cloud has no extent';
}
