import type { CloudPlan } from '../frame/cloud-plan.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import type { CloudShape } from '../frame/frame-shape.ts';

/** What a view holds on the GPU for effects, in bytes. */
export interface EffectHoldings {
  /** Of one cloud: a bit per splat, where an effect takes a selection. */
  selectionBytes(cloudIndex: number): number;
  readonly keptColorsBytes: number;
  /** What the host has drawn, as the splats are tested against it. */
  readonly testedDepthBytes: number;
  /** The splats' own depth, for the host. */
  readonly writtenDepthBytes: number;
}

/** A frame as it was drawn. */
export interface DrawnFrame {
  readonly plan: FramePlan;
  readonly held: EffectHoldings;
}

/** One cloud of a frame. */
export interface DrawnCloud {
  readonly plan: FramePlan;
  /** Number of the cloud in the frame. */
  readonly index: number;
  readonly cloud: CloudPlan;
  readonly shape: CloudShape;
}

interface FoundIn<Place> {
  /** Lower case with hyphens. */
  readonly name: string;
  readonly label: string;
  /** What it does: one sentence. */
  readonly about: string;
  /** What its lines in shaders stand under, `@if(NAME)`: where it is off none of them is met. */
  readonly conditions: readonly string[];
  /** What stages are bound to for it, by the names in their shaders. */
  readonly bindings: readonly string[];
  /** Stages that it may take part in; none where no shader knows of it. */
  readonly stages: readonly string[];
  /** Why it is on, in words, or null where it is off. */
  readonly calledFor: (place: Place) => string | null;
  /** Why it is off, where it is. */
  readonly offReason: (place: Place) => string;
  /** What is held for it; default nothing. */
  readonly bytes?: (frame: DrawnFrame) => number;
}

/** One that each cloud calls for by itself. */
export interface FoundInCloud extends FoundIn<DrawnCloud> {
  readonly of: 'cloud';
}

/** One that the whole view calls for. */
export interface FoundInView extends FoundIn<DrawnFrame> {
  readonly of: 'view';
}

/**
 * An effect that nobody asks for: splats, camera and host call for it. The frame's shape says whether it is on, and with
 * that which shaders are run; this says why.
 */
export type FoundEffect = FoundInCloud | FoundInView;
