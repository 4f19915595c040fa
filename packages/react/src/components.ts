'use client';

// What only some applications show.
export { StageTimings, type StageTimingsProps } from './stage-timings.tsx';
export type { PanelCorner } from './timings-panel.ts';
