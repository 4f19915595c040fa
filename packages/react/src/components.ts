'use client';

// What only some applications show.
export { SplatAnnotation, type SplatAnnotationProps } from './splat-annotation.tsx';
export { SplatStats, type SplatStatsProps } from './splat-stats.tsx';
export type { PanelCorner } from './timings-panel.ts';
