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
 * does; null for the window's own size, smaller if that is too large for a video.
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

/**
 * Codecs of WebM, best first: all browsers play VP9, and most can encode it. Level 5.1 of VP9 and
 * AV1 has 4K at 60 frames a second.
 */
const CODECS = [
  { name: 'vp9', words: 'VP9', codec: 'vp09.00.51.08' },
  { name: 'av1', words: 'AV1', codec: 'av01.0.13M.08' },
  { name: 'vp8', words: 'VP8', codec: 'vp8' },
] as const;

/** Enough for the fine edges of splats. */
const BITS_PER_PIXEL = 0.15;
const LEAST_BITS_PER_S = 1e6;

/** How a video is encoded. */
export interface VideoCodec {
  readonly name: (typeof CODECS)[number]['name'];
  /** Its name in the interface. */
  readonly words: string;
  readonly config: VideoEncoderConfig;
}

/** The browser could not encode a video that it said it could. */
export class VideoError extends Error {
  override readonly name = 'VideoError';
}

/** The first codec that this browser has for a video; null if it has none. */
export async function findCodec(
  [width, height]: VideoSize,
  framerate: FrameRate,
): Promise<VideoCodec | null> {
  if (!('VideoEncoder' in globalThis)) return null;
  const bitrate = Math.max(LEAST_BITS_PER_S, Math.round(BITS_PER_PIXEL * width * height * framerate));
  for (const { name, words, codec } of CODECS) {
    const config: VideoEncoderConfig = { codec, width, height, framerate, bitrate };
    // Browsers may reject instead of answering `supported: false` for an unknown codec.
    const answer = await VideoEncoder.isConfigSupported(config).catch(() => null);
    if (answer?.supported) return { name, words, config };
  }
  return null;
}
