import {
  BufferTarget,
  EncodedPacket,
  EncodedVideoPacketSource,
  Mp4OutputFormat,
  Output,
  WebMOutputFormat,
} from 'mediabunny';
import { type FrameRate, type VideoCodec, VideoError } from './video-format.ts';

/** BT.709 in limited range: the colours that players assume if they ignore the file's metadata. */
const VIDEO_COLORS = {
  fullRange: false,
  matrix: 'bt709',
  primaries: 'bt709',
  transfer: 'bt709',
} as const satisfies VideoColorSpaceInit;

/** How much each channel adds to the brightness. */
const [RED, GREEN, BLUE] = [0.2126, 0.7152, 0.0722];
/** Black, and grey in both differences; the range of either, for channels of 255 steps. */
const [DARKEST, MIDDLE] = [16, 128];
const BRIGHTNESS_SCALE = 219 / 255;
const BLUE_SCALE = 224 / 255 / (2 * (1 - BLUE));
const RED_SCALE = 224 / 255 / (2 * (1 - RED));

/**
 * Converts an image to I420 in `VIDEO_COLORS`: its brightness, then its blue and its red difference
 * for two by two pixels. Browsers would convert it themselves, but Chromium then uses the full
 * range of bytes, which Firefox shows with too much contrast.
 *
 * @param pixels RGBA of an opaque image, top row first, of even width and height.
 */
export function i420Of(
  pixels: Uint8ClampedArray,
  widthPx: number,
  heightPx: number,
): Uint8ClampedArray<ArrayBuffer> {
  const count = widthPx * heightPx;
  const planes = new Uint8ClampedArray((count * 3) / 2);
  let blueAt = count;
  let redAt = count + count / 4;
  for (let y = 0; y < heightPx; y += 2) {
    for (let x = 0; x < widthPx; x += 2) {
      const corner = y * widthPx + x;
      let [red, blue, bright] = [0, 0, 0];
      for (let i = 0; i < 4; i++) {
        const at = corner + (i & 1) + (i >> 1) * widthPx;
        const brightness = RED * pixels[4 * at] + GREEN * pixels[4 * at + 1] + BLUE * pixels[4 * at + 2];
        planes[at] = DARKEST + BRIGHTNESS_SCALE * brightness;
        red += pixels[4 * at];
        blue += pixels[4 * at + 2];
        bright += brightness;
      }
      planes[blueAt++] = MIDDLE + (BLUE_SCALE * (blue - bright)) / 4;
      planes[redAt++] = MIDDLE + (RED_SCALE * (red - bright)) / 4;
    }
  }
  return planes;
}

/** Frames that wait for the encoder: each holds its pixels. */
const MOST_QUEUED = 4;
/** Players jump to frames that need no other. */
const KEY_FRAME_S = 2;

/** Formats by container. In MP4 the index comes first, so that players of web pages begin at once. */
const FORMATS = {
  mp4: () => new Mp4OutputFormat({ fastStart: 'in-memory' }),
  webm: () => new WebMOutputFormat(),
} as const;

/** Writes a video of frames with even times. */
export class VideoWriter {
  readonly #encoder: VideoEncoder;
  readonly #codec: VideoCodec;
  readonly #framesPerS: FrameRate;
  readonly #output: Output<Mp4OutputFormat | WebMOutputFormat, BufferTarget>;
  #frames = 0;
  #failure: VideoError | null = null;
  /** Settles when all encoded frames are in the file. */
  #written: Promise<void>;
  /** Resumes `add` calls that wait for the encoder's queue. */
  #wake = () => {};

  constructor(codec: VideoCodec, framesPerS: FrameRate) {
    this.#codec = codec;
    this.#framesPerS = framesPerS;
    this.#output = new Output({ format: FORMATS[codec.container](), target: new BufferTarget() });
    const source = new EncodedVideoPacketSource(codec.name);
    this.#output.addVideoTrack(source, { frameRate: framesPerS });
    this.#written = this.#output.start();
    this.#encoder = new VideoEncoder({
      output: (chunk, meta) => {
        this.#written = this.#written.then(() => source.add(EncodedPacket.fromEncodedChunk(chunk), meta));
        this.#written.catch((error: Error) => this.#fail(error));
      },
      error: (error) => this.#fail(error),
    });
    this.#encoder.ondequeue = () => this.#wake();
    this.#encoder.configure(codec.config);
  }

  /**
   * Appends a frame; resolves when there is room for the next one.
   *
   * @param pixels RGBA of an opaque image, top row first.
   * @throws VideoError if the browser cannot encode it, or one before.
   */
  async add(pixels: Uint8ClampedArray<ArrayBuffer>): Promise<void> {
    this.#check();
    const index = this.#frames++;
    const { width, height } = this.#codec.config;
    const frame = new VideoFrame(i420Of(pixels, width, height), {
      ...{ format: 'I420', codedWidth: width, codedHeight: height, colorSpace: VIDEO_COLORS },
      timestamp: this.#timeUs(index),
      duration: this.#timeUs(index + 1) - this.#timeUs(index),
    });
    this.#encoder.encode(frame, { keyFrame: index % (KEY_FRAME_S * this.#framesPerS) === 0 });
    frame.close();
    while (this.#encoder.encodeQueueSize > MOST_QUEUED && !this.#failure)
      await new Promise<void>((resolve) => {
        this.#wake = resolve;
      });
    this.#check();
  }

  /** The file, once all frames have been added. @throws VideoError as `add` does. */
  async finish(): Promise<Blob> {
    await this.#encoder.flush().catch((error: Error) => this.#fail(error));
    await this.#written.catch((error: Error) => this.#fail(error));
    this.#check();
    this.#encoder.close();
    await this.#output.finalize();
    const { buffer } = this.#output.target;
    if (!buffer) throw new VideoError('The video has no bytes.');
    return new Blob([buffer], { type: `video/${this.#codec.container}` });
  }

  /** Lets go of the frames. */
  abort(): void {
    if (this.#encoder.state !== 'closed') this.#encoder.close();
    // Who aborts no longer awaits the video.
    this.#written.catch(() => {});
    void this.#output.cancel().catch(() => {});
  }

  #timeUs(index: number): number {
    return Math.round((index * 1e6) / this.#framesPerS);
  }

  #fail({ message }: Error): void {
    const { words, config } = this.#codec;
    this.#failure ??= new VideoError(
      `The browser’s ${words} encoder stopped at ${config.width} × ${config.height} px: ${message}`,
    );
    this.#wake();
  }

  #check(): void {
    if (this.#failure) throw this.#failure;
  }
}
