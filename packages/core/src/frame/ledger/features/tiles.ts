import type { FeatureOfView } from '../automatic-feature.ts';

/** Compute shaders blend splats tile by tile, where that is faster than a quad per splat. */
export const tiles: FeatureOfView = {
  of: 'view',
  name: 'tiles',
  label: 'Tiles',
  about:
    'Blends splats tile by tile in compute shaders, front to back in float32, instead of drawing a quad each.',
  stages: ['tile-count', 'tile-plan', 'tile-emit', 'tile-ranges', 'tile-masks', 'tile-rasterize'],
  calledFor: ({ plan, rasterizer }) => (plan.shape.rasterizer === 'tiles' ? rasterizer.reason : null),
  offReason: ({ rasterizer }) => rasterizer.reason,
  bytes: ({ held }) => held.tilesBytes,
};
