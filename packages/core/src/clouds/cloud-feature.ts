import type { GeometryPrecision } from '../data/packing/precision.ts';
import type { EffectUse } from '../gpu/effects/effect.ts';
import type { Plane } from './cloud-planes.ts';
import type { TouchedSplats } from './levels/touched-links.ts';

/**
 * Something that a cloud may have: motion, edits, a morph, a skin, buffers of the GPU. One object per cloud; what
 * has no meaning for it is absent.
 */
export interface CloudFeature {
  /** What the cloud follows, for messages: `a morph`. */
  readonly name: string;
  /** Why the cloud has no levels of detail, for messages: `it morphs, so …`. Default: it may have them. */
  readonly lacksLevels?: string;
  /** Returns the effect that draws the cloud at a time, before those of the caller. */
  effectAt?(time: number | undefined): EffectUse;
  /** Returns the chunks that may be seen at a time, where they are then. The same buffer for the same chunks. */
  chunksAt?(chunks: ArrayBuffer, time: number | undefined): ArrayBuffer;
  /** Writes what changed since the last call. Called before frames are planned and planes are read. */
  flush?(): void;
  /**
   * Reads `plane` as it was uploaded. The result is called once the cloud holds the plane. Of the features of a
   * cloud, only the one that writes its planes has this.
   */
  rebase?(precision: GeometryPrecision, plane: Plane): Promise<() => void>;
  /** Splats that cuts draw one by one, because levels do not show their changes. */
  readonly touched?: Readonly<TouchedSplats>;
  /** Called before levels are made, so that they are made of the splats as they are now. */
  beginLevels?(): void;
  /** Reads the words of the chunks back, where `SplatCloud.chunks` lacks their bounds: the GPU makes the splats. */
  readChunks?(): Promise<Float32Array>;
  /** Called when the cloud or its engine ends. */
  end?(): void;
}

/** A cloud, or as much of one as has features. */
interface FeaturedCloud {
  readonly features: readonly CloudFeature[];
}

/** The feature that writes the planes of a cloud; undefined if they are as they were uploaded. */
export function writerOf({ features }: FeaturedCloud): CloudFeature | undefined {
  return features.find(({ rebase }) => rebase);
}

/** Has every feature write what changed. */
export function flushFeatures({ features }: FeaturedCloud): void {
  for (const feature of features) feature.flush?.();
}
