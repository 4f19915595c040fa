import type {
  Accuracy,
  AccuracySettings,
  FrameRasterizer,
  PossibleAccuracy,
} from '../data/accuracy/accuracy.ts';
import type { EffectEntry } from '../frame/ledger/ledger.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { FrameShape } from '../frame/plan/frame-shape.ts';
import type { GpuMemoryReport } from '../gpu/gpu-memory.ts';
import type { FrameProfile } from '../gpu/timing/frame-profile.ts';
import type { FrameStatistics } from '../gpu/timing/frame-statistics.ts';
import type { CompareContext } from './compare-textures.ts';

/** The parts of an engine that measuring needs; every `SplatEngine` has them. */
export interface MeasuredEngine {
  readonly device: GPUDevice;
  readonly adapterLabel: string;
  readonly accuracy: AccuracySettings;
  readonly lost: Promise<GPUDeviceLostInfo>;
  resolveAccuracy(accuracy?: Accuracy): PossibleAccuracy;
  createView(): MeasuredView;
  memory(): GpuMemoryReport;
}

/** The parts of a view that comparing needs; every `SplatView` has them. */
export interface ComparedView {
  whenDrawn(): Promise<void>;
  /**
   * Returns the layer of its last image, in the colour space of blending; throws if the view has
   * ended.
   */
  blended(): { readonly context: CompareContext; readonly color: GPUTexture | null };
}

/** The parts of a view that measuring needs; every `SplatView` has them. */
export interface MeasuredView extends ComparedView {
  onStatistics: ((statistics: FrameStatistics) => void) | null;
  /** While set, frames are split into passes and have no statistics. */
  profile: FrameProfile | null;
  /** Shape of the last frame; null before the first. */
  readonly shape: FrameShape | null;
  /** The rasteriser, and the reason for it. */
  readonly rasterizer: { readonly rasterizer: FrameRasterizer; readonly reason: string };
  render(frame: FrameRequest): boolean;
  effects(): readonly EffectEntry[];
  /** Whether frames may use the faster shaders for clouds of round splats only; default true. */
  mayBeIsotropic: boolean;
  destroy(): void;
}
