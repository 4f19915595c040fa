import { shallow } from 'zustand/vanilla/shallow';
import type { LayerImage } from '../state/frames.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import type { Viewer } from './viewer.ts';

/** An image that takes a while to be made of the picture at rest. */
export interface RestLayer<Image extends LayerImage> {
  /** What is to be made of the picture with these `restedFrames`, as text; empty for nothing. */
  readonly asked: (state: ViewerState) => string;
  /** Null where nothing is on the screen. */
  readonly make: () => Promise<Image | null>;
  /** The canvas shows this now; null: it is hidden. */
  readonly onShow: (image: Image | null) => void;
  readonly onFail?: (error: Error) => void;
}

/**
 * Keeps a layer on `canvas`, over the picture. The canvas is hidden while the picture moves, and
 * comes back when the layer of the frame at rest has been made: of one at a time, then of the
 * newest. Returns a function that stops this.
 */
export function drawAtRest<Image extends LayerImage>(
  canvas: HTMLCanvasElement,
  viewer: Pick<Viewer, 'shownFrame'>,
  store: ViewerStore,
  { asked, make, onShow, onFail }: RestLayer<Image>,
): () => void {
  /** What was made last, or is being made. */
  let begun = '';
  let drawn: { readonly key: string; readonly image: Image } | null = null;
  let isBusy = false;
  let isStopped = false;
  const askedNow = () => (store.getState().isIdle ? asked(store.getState()) : '');

  const follow = async () => {
    const key = askedNow();
    const image = key !== '' && key === drawn?.key ? drawn.image : null;
    canvas.hidden = image === null;
    onShow(image);
    if (!key || key === begun || isBusy || !viewer.shownFrame) return;
    begun = key;
    isBusy = true;
    const isNeeded = () => !isStopped && askedNow() === key;
    try {
      const made = await make();
      if (made && isNeeded()) {
        drawLayer(canvas, made);
        drawn = { key, image: made };
        onShow(made);
      }
    } catch (error) {
      // A lost device or a replaced scene ends it too; the viewer reports both itself.
      if (isNeeded() && store.getState().status === 'running') {
        console.error(error);
        onFail?.(error as Error);
      }
    } finally {
      isBusy = false;
      // The same picture may come to rest again.
      if (!isNeeded()) begun = '';
    }
    if (!isStopped && askedNow() !== begun) void follow();
  };

  void follow();
  const unsubscribe = store.subscribe(
    (state) => [state.isIdle, asked(state)],
    () => void follow(),
    { equalityFn: shallow },
  );
  return () => {
    isStopped = true;
    unsubscribe();
  };
}

/** Shows an image on a canvas of its size. */
export function drawLayer(canvas: HTMLCanvasElement, { data, widthPx, heightPx }: LayerImage): void {
  canvas.width = widthPx;
  canvas.height = heightPx;
  canvas.getContext('2d')?.putImageData(new ImageData(data, widthPx, heightPx), 0, 0);
  canvas.hidden = false;
}
