import type { Bounds, SplatSet } from '@websplatter/core';
import type { StoredSource } from '../rereading/stored-source.ts';
import type { Crop, CropCount, Histograms, MarkedBin } from '../state/inspecting.ts';

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

/** What can be asked of a scene, and the answer to each. */
export interface Answers {
  /** A set of the splat in a row alone; null if there is none. */
  splat: {
    readonly question: { readonly cloudIndex: number; readonly row: number };
    answer: SplatSet | null;
  };
  histograms: { readonly question: null; answer: Histograms };
  /** The rows of the splats in a bin, of all clouds. */
  rows: { readonly question: MarkedBin; answer: Uint32Array<ArrayBuffer> };
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
  /** 0…1 of what is read; undefined where that is not known. */
  | { readonly kind: 'progress'; readonly part: number | undefined }
  | { readonly kind: 'read' }
  | { readonly kind: 'failed'; readonly message: string }
  | { readonly kind: 'answer'; readonly id: number; readonly answer: Answers[Topic]['answer'] };
