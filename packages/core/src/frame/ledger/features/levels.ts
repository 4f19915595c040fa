import { type Detail, isFixedDetail, percentText } from '../../detail.ts';
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
    'touch-links',
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
  calledFor: ({ plan: { detail, request }, shape }) => {
    if (!shape.levels) return null;
    if (detail === 'full') return shape.cloud.pool ? 'blobs stand for what is missing of the scene' : null;
    const { maxErrorPx, maxSplats, maxShare } = detail;
    const limits = [
      ...(maxErrorPx === undefined ? [] : [`errors up to ${maxErrorPx} px are allowed`]),
      ...(maxSplats === undefined ? [] : [`at most ${maxSplats.toLocaleString('en')} splats are asked for`]),
      ...(maxShare === undefined ? [] : [`at most ${percentText(maxShare)} of the splats are asked for`]),
    ];
    return [...limits, ...aims(request.detail)].join(', ');
  },
  offReason,
};

function offReason({ plan, cloud }: DrawnCloud): string {
  const { detail: asked = 'full' } = plan.request;
  if (asked === 'full' || plan.detail !== 'full') return cloud.inFull ?? 'they are being made';
  if (!isFixedDetail(asked)) return ['all splats are drawn', ...aims(asked)].join(', ');
  return asked.maxSplats === undefined && asked.maxShare === undefined
    ? 'no error is allowed'
    : 'all splats are within the budget';
}

/** The outcome that detail is found for; none where it is given. */
function aims(asked: Detail = 'full'): string[] {
  if (isFixedDetail(asked)) return [];
  if (asked === 'auto') return ['for frames as quick as screens'];
  return ['minPsnrDb' in asked ? `for ${asked.minPsnrDb} dB` : `for frames within ${asked.maxFrameMs} ms`];
}
