import { WebSplatterError } from '@websplatter/core';
import { shownBytes } from '@websplatter/kit/shown-pixels';
import { frameOfView } from '../engine/frame-of-view.ts';
import { pathThrough, placeOnPath, poseOnPath } from '../navigate/view-path.ts';
import type { SavedView } from '../state/saved-view.ts';
import { FileWork, perViewer, savedName } from './file-work.ts';
import { type FrameRate, frameCount, type VideoCodec, VideoError } from './video-format.ts';

export interface VideoOptions {
  readonly codec: VideoCodec;
  readonly framesPerS: FrameRate;
}

/** Saves the path through the saved views as a video, one at a time. */
class Videos extends FileWork {
  /** Draws the video and hands it to the browser. Does nothing without a path, or while busy. */
  async start(options: VideoOptions): Promise<void> {
    const { store } = this;
    const path = pathThrough(store.getState().savedViews);
    if (!this.viewer.shownFrame || path.length < 2 || this.isBusy) return;
    const fileName = savedName([store.getState().scene?.title ?? ''], { extension: '.webm' });
    const frames = frameCount(path.length, options.framesPerS);
    const report = (drawnFrames: number) => store.setState({ filming: { fileName, drawnFrames, frames } });
    report(0);
    await this.run({
      fileName,
      doing: 'Drawing',
      make: (signal) => this.#draw(path, options, report, signal),
      failureOf: (error) => ({
        title: `${fileName} cannot be made`,
        advice: 'Nothing was saved. Try a smaller size, or fewer frames per second.',
        isFault: !(error instanceof WebSplatterError || error instanceof VideoError),
      }),
      onEnd: () => store.setState({ filming: null }),
    });
  }

  /** @throws VideoError; errors of `render`, `whenComplete` and `readPixels`. */
  async #draw(
    path: readonly SavedView[],
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
    const { isFlipped, accuracy } = this.store.getState();
    const { width: widthPx, height: heightPx } = codec.config;
    const [red, green, blue] = frame.background ?? [0, 0, 0];
    const poses = path.map(({ pose }) => pose);
    const frames = frameCount(path.length, framesPerS);
    const writer = new VideoWriter(codec, framesPerS);
    // A view of its own: the screen's image stays, and the memory goes when the video is there.
    const view = engine.createView();
    try {
      for (let i = 0; i < frames; i++) {
        const place = placeOnPath((i * 1000) / framesPerS, path.length);
        const seen = { ...path[0], pose: poseOnPath(poses, place) };
        const shown = frameOfView(frame, isFlipped, camera, seen, { widthPx, heightPx });
        view.render({ ...shown, accuracy, detail: 'full' });
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
    }
  }
}

/** The viewer's one `Videos`, made at the first call. */
export const videosOf = perViewer((viewer, store) => new Videos(viewer, store));
