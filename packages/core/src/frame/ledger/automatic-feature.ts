import type { CloudPlan } from '../cloud-plan.ts';
import type { FramePlan } from '../frame-plan.ts';
import type { CloudShape } from '../frame-shape.ts';

/** GPU memory that a view holds for effects, in bytes. */
export interface EffectHoldings {
  /** Selection of one cloud: a bit per splat, if an effect takes it. */
  selectionBytes(cloudIndex: number): number;
  /** Levels of the chunks of one cloud, if an effect takes them. */
  levelBytes(cloudIndex: number): number;
  /** The host's depth that splats are tested against. */
  readonly testedDepthBytes: number;
  /** The splats' own depth, for the host. */
  readonly writtenDepthBytes: number;
  /** Lists of the tiles. */
  readonly tilesBytes: number;
}

/** A frame that was drawn. */
export interface DrawnFrame {
  readonly plan: FramePlan;
  readonly held: EffectHoldings;
  /** Why it was drawn by tiles or quads, for people. */
  readonly rasterizer: { readonly reason: string };
}

/** One cloud of a frame. */
export interface DrawnCloud {
  readonly plan: FramePlan;
  /** Index of the cloud in the frame. */
  readonly index: number;
  readonly cloud: CloudPlan;
  readonly shape: CloudShape;
}

interface FeatureOf<Place> {
  /** Lower case with hyphens. */
  readonly name: string;
  readonly label: string;
  /** One sentence that says what the effect does. */
  readonly about: string;
  /** Stages that it may take part in; none if it is not in any shader. */
  readonly stages: readonly string[];
  /** Returns why it is on, or null if it is off. */
  readonly calledFor: (place: Place) => string | null;
  /** Returns why it is off; call only if it is. */
  readonly offReason: (place: Place) => string;
  /** Bytes of GPU memory held for it; default none. */
  readonly bytes?: (frame: DrawnFrame) => number;
}

/** An automatic feature that is on or off per cloud. */
export interface FeatureOfCloud extends FeatureOf<DrawnCloud> {
  readonly of: 'cloud';
}

/** An automatic feature that is on or off for the whole view. */
export interface FeatureOfView extends FeatureOf<DrawnFrame> {
  readonly of: 'view';
}

/**
 * An effect that splats, camera or host make necessary. The frame's shape decides whether it is on,
 * and thereby which shaders run; this entry gives the reason.
 */
export type AutomaticFeature = FeatureOfCloud | FeatureOfView;
