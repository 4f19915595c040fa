import type { FixedDetail, FrameStatistics, RasterizerReport, StreamReport } from '@websplatter/core';

/** An image as `ImageData` holds it. */
export interface LayerImage {
  readonly widthPx: number;
  readonly heightPx: number;
  readonly data: Uint8ClampedArray<ArrayBuffer>;
}

/** Pace of the newest run of frames. */
export interface MeasuredRate {
  /** Mean time between frames. */
  readonly frameMs: number;
  readonly framesPerSecond: number;
}

/** The calls that asked the engine for one frame: of both sides, in a split image. */
export interface RenderCall {
  /** CPU time until the calls returned. */
  readonly elapsedMs: number;
}

/** State of all scenes that stream, together. */
export type Streaming = Pick<
  StreamReport,
  'bricks' | 'residentBricks' | 'missingBricks' | 'fetchedBytes' | 'bytesPerSecond' | 'error'
>;

/** The frames that were drawn last. */
export interface FramesState {
  readonly widthPx: number;
  readonly heightPx: number;
  /** How many frames have been on the screen; overlays follow them. */
  readonly shownFrames: number;
  /** Another number for each scene, view, size and detail that came to rest, at any accuracy. */
  readonly imageId: number;
  /** How many frames had been drawn when the image came to rest. */
  readonly restedFrames: number;
  /** Whether nothing changes, so that nothing is drawn. */
  readonly isIdle: boolean;
  readonly statistics: FrameStatistics | null;
  /** The rasteriser after that frame, and the facts known about both. */
  readonly rasterizer: RasterizerReport | null;
  /** Detail of the last frame, and its part of the width and height that was asked for. */
  readonly drawnDetail: FixedDetail;
  readonly movingScale: number;
  /** Statistics of the right side of a split image; null without one. */
  readonly rightStatistics: FrameStatistics | null;
  /** Rasteriser of the right side of a split image; null without one. */
  readonly rightRasterizer: RasterizerReport | null;
  /** Null if nothing streams. */
  readonly streaming: Streaming | null;
  readonly lastRender: RenderCall | null;
  /** Null after a single frame, which has no pace. */
  readonly frameRate: MeasuredRate | null;
}

/** Whether a scene that streams has nothing on the screen yet, and more of it is on the way. */
export function awaitsFirstParts({
  streaming,
  statistics,
}: Pick<FramesState, 'streaming' | 'statistics'>): boolean {
  const isOnTheWay = streaming !== null && streaming.missingBricks > 0 && streaming.error === null;
  return isOnTheWay && !statistics?.visibleSplats;
}

export const FIRST_FRAMES: FramesState = {
  widthPx: 0,
  heightPx: 0,
  shownFrames: 0,
  imageId: 0,
  restedFrames: 0,
  isIdle: true,
  statistics: null,
  rasterizer: null,
  drawnDetail: 'full',
  movingScale: 1,
  rightStatistics: null,
  rightRasterizer: null,
  streaming: null,
  lastRender: null,
  frameRate: null,
};
