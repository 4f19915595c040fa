import type { Accuracy, AccuracySettings, PossibleAccuracy } from '../accuracy/accuracy.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { OmittableEffect } from '../frame/frame-shape.ts';
import type { GpuMemoryReport } from '../gpu/gpu-memory.ts';
import type { EffectEntry } from '../ledger/ledger.ts';
import type { FrameStatistics } from '../timing/frame-statistics.ts';
import type { CompareContext } from './compare-textures.ts';

/** What measuring needs of an engine: every `SplatEngine` has it. */
export interface MeasuredEngine {
  readonly device: GPUDevice;
  readonly adapterLabel: string;
  readonly accuracy: AccuracySettings;
  readonly lost: Promise<GPUDeviceLostInfo>;
  resolveAccuracy(accuracy?: Accuracy): PossibleAccuracy;
  createView(): MeasuredView;
  memory(): GpuMemoryReport;
}

/** What comparing needs of a view: every `SplatView` has it. */
export interface ComparedView {
  whenDrawn(): Promise<void>;
  /** The splats of its last picture, in the space they were blended in; throws where it can draw no more. */
  blended(): { readonly context: CompareContext; readonly color: GPUTexture | null };
}

/** What measuring needs of a view: every `SplatView` has it. */
export interface MeasuredView extends ComparedView {
  onStatistics: ((statistics: FrameStatistics) => void) | null;
  render(frame: FrameRequest): boolean;
  effects(): readonly EffectEntry[];
  omitEffects(effects: readonly OmittableEffect[]): void;
  destroy(): void;
}
