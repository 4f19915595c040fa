import { type SplatEngine, WebSplatterError } from '@websplatter/core';
import { shownBytes } from '@websplatter/kit/shown-pixels';
import type { FilmedFrames } from '../engine/play/open-frame-file.ts';
import { timeAfter, timingOf } from '../engine/play/scene-time.ts';
import { frameOfView } from '../engine/show/frame-of-view.ts';
import { type CameraPath, pathOf, viewOnPath } from '../navigate/view-path.ts';
import { FileWork, perViewer, sceneFileName } from './file-work.ts';
import {
  CONTAINERS,
  type Container,
  FRAME_RATES,
  type FrameRate,
  frameCount,
  type VideoCodec,
  VideoError,
  type VideoQuality,
} from './video-format.ts';

/** Frames after which the time that is left can be told: the first ones also fetch and compile code. */
const TIMED_FRAMES = 3;

export interface VideoOptions {
  readonly codec: VideoCodec;
  readonly framesPerS: FrameRate;
}

/** Format, size, rate and quality of a video. */
export interface VideoChoices {
  readonly container: Container;
  /** Pixels over the shorter side; null for the window's size. */
  readonly lines: number | null;
  readonly framesPerS: FrameRate;
  readonly quality: VideoQuality;
}

/** Saves the camera path as a video, one at a time. */
class Videos extends FileWork {
  /** Kept while the panel is closed. */
  choices: VideoChoices = {
    container: CONTAINERS[0],
    lines: null,
    framesPerS: FRAME_RATES[0],
    quality: 'good',
  };

  /** Draws the video and hands it to the browser. Does nothing without a path, or while busy. */
  async start(options: VideoOptions): Promise<void> {
    const { store } = this;
    const path = pathOf(store.getState());
    if (!this.viewer.shownFrame || !path || this.isBusy) return;
    const extension = `.${options.codec.container}`;
    const fileName = sceneFileName(this.viewer, { extension });
    const frames = frameCount(path, options.framesPerS);
    const startedMs = performance.now();
    const report = (drawnFrames: number) => {
      const leftMs = ((performance.now() - startedMs) / drawnFrames) * (frames - drawnFrames);
      store.setState({
        filming: { fileName, drawnFrames, frames, leftMs: drawnFrames < TIMED_FRAMES ? null : leftMs },
      });
    };
    report(0);
    await this.run({
      fileName,
      doing: 'Drawing',
      make: (signal) => this.#draw(path, options, report, signal),
      failureOf: (error) => ({
        title: `${fileName} cannot be made`,
        advice: 'Nothing was saved. Try a smaller size, fewer frames per second, or another format.',
        isFault: !(error instanceof WebSplatterError || error instanceof VideoError),
      }),
      onEnd: () => store.setState({ filming: null }),
    });
  }

  /** @throws VideoError; errors of `render`, `whenComplete` and `readPixels`. */
  async #draw(
    path: CameraPath,
    { codec, framesPerS }: VideoOptions,
    onDrawn: (frames: number) => void,
    signal: AbortSignal,
  ): Promise<Blob> {
    // A library that writes videos: most pages never do.
    const { VideoWriter } = await import('./video-writer.ts');
    const { camera, shownFrame } = this.viewer;
    signal.throwIfAborted();
    if (!shownFrame) throw new Error('The scene is no longer shown.');
    const { engine, centred: frame } = shownFrame;
    const { isFlipped, accuracy, sceneTime } = this.store.getState();
    const timing = timingOf(this.viewer.scenes.newest);
    // Few scenes have frames.
    const filmed = timing?.framesPerS ? await this.#filmedFrames(engine) : null;
    const { width: widthPx, height: heightPx } = codec.config;
    const [red, green, blue] = frame.background ?? [0, 0, 0];
    const frames = frameCount(path, framesPerS);
    const writer = new VideoWriter(codec, framesPerS);
    // A view of its own: the screen's image stays, and the memory goes when the video is there.
    const view = engine.createView();
    try {
      for (let i = 0; i < frames; i++) {
        const seen = viewOnPath(path, (i * 1000) / framesPerS);
        const shown = frameOfView(frame, isFlipped, camera, seen, { widthPx, heightPx });
        const time = timing
          ? timeAfter(timing, sceneTime ?? timing.range[0], (i * 1000) / framesPerS)
          : undefined;
        const timed = shown.clouds.map((cloud) => ({ ...cloud, time }));
        const clouds = filmed ? await filmed.at(timed, time ?? 0) : timed;
        view.render({ ...shown, clouds, accuracy, detail: 'full' });
        await view.whenComplete();
        const { data } = await view.readPixels();
        signal.throwIfAborted();
        await writer.add(shownBytes(data, [red, green, blue]));
        signal.throwIfAborted();
        onDrawn(i + 1);
      }
      return await writer.finish();
    } catch (error) {
      writer.abort();
      throw error;
    } finally {
      view.destroy();
      filmed?.end();
    }
  }

  async #filmedFrames(engine: SplatEngine): Promise<FilmedFrames> {
    const { FilmedFrames } = await import('../engine/play/open-frame-file.ts');
    return FilmedFrames.open(engine, this.viewer.scenes.newest?.parts ?? []);
  }
}

/** The viewer's one `Videos`, made at the first call. */
export const videosOf = perViewer((viewer, store) => new Videos(viewer, store));
