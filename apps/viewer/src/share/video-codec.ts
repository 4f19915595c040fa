import type { FrameRate, VideoSize } from './video-frames.ts';

/**
 * What WebM may hold, best first: all browsers play VP9, and most can encode it. Of VP9 and AV1,
 * level 5.1 is asked for, which has 4K at 60 frames a second.
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

/** The first codec that this browser has for such videos; null where it has none. */
export async function findCodec(
  [width, height]: VideoSize,
  framerate: FrameRate,
): Promise<VideoCodec | null> {
  if (!('VideoEncoder' in globalThis)) return null;
  const bitrate = Math.max(LEAST_BITS_PER_S, Math.round(BITS_PER_PIXEL * width * height * framerate));
  for (const { name, words, codec } of CODECS) {
    const config: VideoEncoderConfig = { codec, width, height, framerate, bitrate };
    // Browsers may refuse to read what they do not know.
    const answer = await VideoEncoder.isConfigSupported(config).catch(() => null);
    if (answer?.supported) return { name, words, config };
  }
  return null;
}
