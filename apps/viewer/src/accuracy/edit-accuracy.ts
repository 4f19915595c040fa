import type { AccuracySettings } from '@websplatter/core';
import { editPicture } from '../engine/edit-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import type { Comparison } from '../state/accuracy.ts';

/** Draws with settings that a person has chosen. @param gesture as for `editPicture`. */
export function setAccuracy(panel: PanelProps, settings: AccuracySettings, gesture?: object): void {
  editPicture(panel, 'accuracy', () => panel.viewer.setAccuracy(settings), gesture);
}

/** Shows a comparison that a person has chosen; null ends it. */
export function compare(panel: PanelProps, comparison: Comparison | null): void {
  editPicture(panel, 'comparison', () => panel.viewer.compare(comparison));
}
