import type { CameraPath } from '../navigate/view-path.ts';

/** Frames a second that are offered. */
export const FRAME_RATES = [30, 60] as const;
export type FrameRate = (typeof FRAME_RATES)[number];

/** Width and height in pixels. */
export type VideoSize = readonly [widthPx: number, heightPx: number];

/** Encoders are asked for level 5.1, whose pictures are no larger. */
const MOST_SIDE_PX = 4096;
const MOST_PIXELS = 2 ** 23;

/**
 * How many frames a video of the path has: the first shows its first view, the last its last. A
 * video of a loop ends one frame before it would begin anew.
 */
export function frameCount(
  { durationMs, isLooped }: Pick<CameraPath, 'durationMs' | 'isLooped'>,
  framesPerS: FrameRate,
): number {
  return Math.max(1, Math.round((durationMs * framesPerS) / 1000) + (isLooped ? 0 : 1));
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

/** Files that are offered: all players know the first, and all browsers encode the second. */
export const CONTAINERS = ['mp4', 'webm'] as const;
export type Container = (typeof CONTAINERS)[number];

/**
 * Codecs by container, best first. Those of MP4 are what its players expect; H.264 without its High
 * profile is what some encoders have. Levels 5.1 and 5.2 have 4K at 60 frames a second.
 */
const CODECS = {
  mp4: [
    { name: 'avc', words: 'H.264', codec: 'avc1.640034' },
    { name: 'avc', words: 'H.264', codec: 'avc1.420034' },
    { name: 'av1', words: 'AV1', codec: 'av01.0.13M.08' },
    { name: 'vp9', words: 'VP9', codec: 'vp09.00.51.08' },
  ],
  webm: [
    { name: 'vp9', words: 'VP9', codec: 'vp09.00.51.08' },
    { name: 'av1', words: 'AV1', codec: 'av01.0.13M.08' },
    { name: 'vp8', words: 'VP8', codec: 'vp8' },
  ],
} as const;

/** Bits per pixel: `good` is enough for the fine edges of splats. */
export const QUALITIES = { small: 0.06, good: 0.15, best: 0.35 } as const;
export type VideoQuality = keyof typeof QUALITIES;
const LEAST_BITS_PER_S = 1e6;

/** How a video is encoded. */
export interface VideoCodec {
  readonly container: Container;
  readonly name: (typeof CODECS)[Container][number]['name'];
  /** Its name in the interface. */
  readonly words: string;
  readonly config: VideoEncoderConfig & { readonly bitrate: number };
}

/** The browser could not encode a video that it said it could. */
export class VideoError extends Error {
  override readonly name = 'VideoError';
}

/** The first codec that this browser has for a video; null if it has none. */
export async function findCodec(
  container: Container,
  [width, height]: VideoSize,
  framerate: FrameRate,
): Promise<VideoCodec | null> {
  if (!('VideoEncoder' in globalThis)) return null;
  const bitrate = bitrateOf([width, height], framerate, 'good');
  for (const { name, words, codec } of CODECS[container]) {
    const config = { codec, width, height, framerate, bitrate };
    // Browsers may reject instead of answering `supported: false` for an unknown codec.
    const answer = await VideoEncoder.isConfigSupported(config).catch(() => null);
    if (answer?.supported) return { container, name, words, config };
  }
  return null;
}

/** The codec with the bits of another quality. */
export function withQuality(codec: VideoCodec, quality: VideoQuality): VideoCodec {
  const { width, height, framerate } = codec.config;
  const bitrate = bitrateOf([width, height], framerate ?? FRAME_RATES[0], quality);
  return { ...codec, config: { ...codec.config, bitrate } };
}

function bitrateOf([widthPx, heightPx]: VideoSize, framesPerS: number, quality: VideoQuality): number {
  return Math.max(LEAST_BITS_PER_S, Math.round(QUALITIES[quality] * widthPx * heightPx * framesPerS));
}

/** Names of a container's codecs, e.g. `H.264, AV1 and VP9`. */
export function codecNames(container: Container): string {
  return new Intl.ListFormat('en').format(new Set(CODECS[container].map(({ words }) => words)));
}
