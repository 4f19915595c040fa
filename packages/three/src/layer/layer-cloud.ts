import type {
  AccuracyChoice,
  AccuracyRequest,
  AccuracySettings,
  CloudInstance,
  CloudStream,
  Detail,
  ShDegree,
  SplatCloud,
  SplatEngine,
} from '@websplatter/core';
import type { EffectUse, SplatEffect } from '@websplatter/core/effects';
import type { Box3, BufferGeometry, Camera, Object3D, Scene } from 'three/webgpu';
import type { SplatInstances } from '../cloud/splat-instances.ts';

/**
 * The part of `SplatCloudObject` that a layer uses to draw it. Fields are read before each draw, and request no frame
 * when they are set.
 */
export interface LayerCloud extends Object3D {
  readonly data: object | null;
  readonly drawnOpacity: number;
  readonly time: number | null;
  readonly drawnFade: number;
  /** Whether splats of it are on the screen. */
  readonly isDrawn: boolean;
  readonly shDegree: ShDegree;
  readonly depthWrite: boolean;
  readonly accuracy: AccuracyRequest | null;
  readonly detail: Detail | null;
  readonly instances?: SplatInstances | null;
  /** Empty except for the bounds of the cloud, in its own space. */
  readonly geometry: BufferGeometry;
  readonly worldBounds: Box3;
  leave(layer: CloudLayer): void;
  uploadedTo(engine: SplatEngine): SplatCloud | null;
  hold(engine: SplatEngine, settings: AccuracySettings | null): void;
  effectsAt(nowMs: number, scene: Scene, camera: Camera): readonly EffectUse[] | null;
  requestFrame(): void;
  announceDrawn(nowMs: number, drawn: readonly SplatEffect[], stream: CloudStream | null): void;
  announceAccuracy(choice: AccuracyChoice): void;
  tell(error: unknown): boolean;
}

/** Where and when a cloud is drawn. */
export interface FramePlace {
  readonly renderer: object;
  readonly scene: Scene;
  readonly camera: Camera;
  readonly object: Object3D;
}

/** A use of an effect of three's nodes, whose uniforms may change in each frame. */
export interface FrameUse extends EffectUse {
  /** Returns the use with the parameters that it has in a frame. */
  inFrame?(place: FramePlace): EffectUse;
}

/** A cloud in a frame, with the accuracy and the detail that it requests for the whole frame. */
export type DrawnCloud = CloudInstance & Pick<LayerCloud, 'accuracy' | 'detail'>;

/** The part of a layer that a cloud uses to leave it. */
export interface CloudLayer {
  drop(cloud: LayerCloud): void;
}
