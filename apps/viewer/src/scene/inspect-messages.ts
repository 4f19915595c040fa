import type { Bounds, SplatSet } from '@websplatter/core';
import type { StoredSource } from '../engine/open/stored-source.ts';
import type { Crop, Histograms, MarkedBin } from '../state/inspecting.ts';
import type { DragRegion, FloaterFilter, PickedRegion } from '../state/selecting.ts';
import type { Vec3 } from '../state/vec3.ts';

/** A cloud of the scene, with the source to read it from. */
export interface CloudToRead {
  readonly source: StoredSource;
  /** Cloud to scene, column-major; null for the identity. */
  readonly modelMatrix: readonly number[] | null;
}

/** The camera, and the orientation of the scene. */
export interface SceneLook {
  /** Column-major. */
  readonly viewMatrix: readonly number[];
  readonly projectionMatrix: readonly number[];
  /** Whether the scene is drawn upside down. */
  readonly isFlipped: boolean;
}

/** Which splats a question is about. */
export type Region =
  | { readonly kind: 'all' }
  /** Splats in one bin of a histogram. */
  | { readonly kind: 'bin'; readonly marked: MarkedBin }
  /** Splats whose centres lie in a dragged region of an image; width and height in CSS pixels. */
  | {
      readonly kind: 'dragged';
      readonly dragged: DragRegion;
      readonly width: number;
      readonly height: number;
      readonly look: SceneLook;
    }
  /** Splats beyond a limit; see `floaterTest`. */
  | { readonly kind: 'floaters'; readonly filter: FloaterFilter; readonly limit: number }
  | PickedRegion;

/** Questions about a scene, with the type of each answer. */
export interface Answers {
  /** A splat set with only the splat of this row; null if the row has none. */
  splat: {
    readonly question: { readonly cloudIndex: number; readonly row: number };
    answer: SplatSet | null;
  };
  histograms: { readonly question: null; answer: Histograms };
  /**
   * For each cloud one bit per row: whether the crop keeps its splat and the region contains it.
   */
  within: {
    readonly question: { readonly region: Region; readonly crop: Crop | null };
    answer: readonly Uint32Array<ArrayBuffer>[];
  };
  /** Centres of at most `most` splats of these rows, evenly chosen; one mask per cloud, null for none. */
  sample: {
    readonly question: { readonly rows: readonly (Uint32Array | null)[]; readonly most: number };
    answer: readonly Vec3[];
  };
  /** A colour for marks that differs from the scene, sRGB, 0…1. */
  markColor: { readonly question: null; answer: Vec3 };
  /** Bounding box of all centres in the image; null if there are none. */
  seen: { readonly question: SceneLook; answer: Bounds | null };
}

export type Topic = keyof Answers;

export type Question = {
  [About in Topic]: { readonly about: About; readonly question: Answers[About]['question'] };
}[Topic];
