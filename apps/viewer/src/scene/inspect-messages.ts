import type { Bounds, SplatSet } from '@websplatter/core';
import type { StoredSource } from '../engine/stored-source.ts';
import type { Crop, CropCount, Histograms, MarkedBin } from '../state/inspecting.ts';
import type { DragRegion, PickedRegion } from '../state/selecting.ts';

/** A cloud of the scene, to be read again. */
export interface CloudToRead {
  readonly source: StoredSource;
  /** Cloud to scene, column-major; null for the identity. */
  readonly modelMatrix: readonly number[] | null;
}

/** How the scene is looked at. */
export interface Look {
  /** Column-major. */
  readonly viewMatrix: readonly number[];
  readonly projectionMatrix: readonly number[];
  /** Whether the scene is drawn upside down. */
  readonly isFlipped: boolean;
}

/** Which splats are asked for. */
export type Region =
  | { readonly kind: 'all' }
  /** Those of a bin of the histograms. */
  | { readonly kind: 'bin'; readonly marked: MarkedBin }
  /** Those whose centres a drag has covered in an image of this size, CSS px. */
  | {
      readonly kind: 'dragged';
      readonly dragged: DragRegion;
      readonly width: number;
      readonly height: number;
      readonly look: Look;
    }
  | PickedRegion;

/** Questions that a scene answers, with the type of each answer. */
export interface Answers {
  /** A set of the splat in a row alone; null if there is none. */
  splat: {
    readonly question: { readonly cloudIndex: number; readonly row: number };
    answer: SplatSet | null;
  };
  histograms: { readonly question: null; answer: Histograms };
  /** Of each cloud a bit per row: whether its splat is in the region, and left by the crop. */
  within: {
    readonly question: { readonly region: Region; readonly crop: Crop | null };
    answer: readonly Uint32Array<ArrayBuffer>[];
  };
  count: { readonly question: Crop; answer: CropCount };
  /** The box around all centres that are within the image; null if there are none. */
  seen: { readonly question: Look; answer: Bounds | null };
}

export type Topic = keyof Answers;

export type AskRequest = {
  [About in Topic]: {
    readonly kind: 'ask';
    readonly id: number;
    readonly about: About;
    readonly question: Answers[About]['question'];
  };
}[Topic];

export type InspectRequest = { readonly kind: 'read'; readonly clouds: readonly CloudToRead[] } | AskRequest;

export type InspectReply =
  /** 0…1 of the bytes to read; undefined if their number is unknown. */
  | { readonly kind: 'progress'; readonly part: number | undefined }
  | { readonly kind: 'read' }
  | { readonly kind: 'failed'; readonly message: string }
  | { readonly kind: 'answer'; readonly id: number; readonly answer: Answers[Topic]['answer'] };
