import { pathMs } from '../navigate/view-path.ts';

/** Frames a second that are offered. */
export const FRAME_RATES = [30, 60] as const;
export type FrameRate = (typeof FRAME_RATES)[number];

/** Width and height in pixels. */
export type VideoSize = readonly [widthPx: number, heightPx: number];

/** Encoders are asked for level 5.1, whose pictures are no larger. */
const MOST_SIDE_PX = 4096;
const MOST_PIXELS = 2 ** 23;

/** How many frames a video of the path has: the first shows the first view, the last the last. */
export function frameCount(views: number, framesPerS: FrameRate): number {
  return Math.round((pathMs(views) * framesPerS) / 1000) + 1;
}

/**
 * The size of a video.
 *
 * @param lines pixels over its shorter side, of a 16:9 video that lies or stands as the window
 * does; null for the window's own size, smaller where that is too large for a video.
 */
export function videoSize(lines: number | null, windowSize: VideoSize): VideoSize {
  const [widthPx, heightPx] = windowSize;
  if (lines === null) {
    const scale = Math.min(
      1,
      MOST_SIDE_PX / Math.max(widthPx, heightPx),
      Math.sqrt(MOST_PIXELS / (widthPx * heightPx)),
    );
    return [even(widthPx * scale), even(heightPx * scale)];
  }
  const longPx = even((lines * 16) / 9);
  return widthPx < heightPx ? [lines, longPx] : [longPx, lines];
}

/** Colours are encoded for two by two pixels at once. */
function even(sidePx: number): number {
  return Math.max(2, 2 * Math.floor(sidePx / 2));
}
