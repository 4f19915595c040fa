import type { EmbeddedFrameRequest, EmbeddedView } from '../views/embedded-view.ts';

/** Prepares a frame, and waits until the view has its shaders. */
export async function prepared(view: EmbeddedView, frame: EmbeddedFrameRequest): Promise<void> {
  while (!view.prepare(frame)) {
    await new Promise<void>((resolve) => {
      view.onReady = resolve;
    });
  }
}
