/**
 * Components that some apps need: bounds, labels, annotations, measuring, statistics, volumes.
 *
 * @module
 */
'use client';

// Parts that only some applications show.
export type { SplatVolumeObject } from '@websplatter/three';
export type { Measurement, MeasureUnit } from './measure-tool.ts';
export { SplatAnnotation, type SplatAnnotationProps } from './splat-annotation.tsx';
export {
  SplatBounds,
  type SplatBoundsApi,
  type SplatBoundsBox,
  type SplatBoundsProps,
  useSplatBounds,
} from './splat-bounds.tsx';
export { SplatInstances, type SplatInstancesProps } from './splat-instances.tsx';
export { SplatMeasure, type SplatMeasureProps } from './splat-measure.tsx';
export { SplatStats, type SplatStatsProps } from './splat-stats.tsx';
export { SplatVolume, type SplatVolumeProps } from './splat-volume.tsx';
export type { PanelCorner } from './timings-panel.ts';
