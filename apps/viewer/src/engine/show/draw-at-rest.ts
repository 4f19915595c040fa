import { shallow } from 'zustand/vanilla/shallow';
import type { LayerImage } from '../../state/frames.ts';
import type { ViewerState, ViewerStore } from '../../state/store.ts';
import type { Viewer } from '../viewer.ts';

/** A layer over the picture that is slow to make, and is therefore made only for frames at rest. */
export interface RestLayer<Image extends LayerImage> {
  /** Key of the layer that the state asks for: a new key makes a new layer. Empty: no layer. */
  readonly asked: (state: ViewerState) => string;
  /** Resolves to null if no frame is on the screen. */
  readonly make: () => Promise<Image | null>;
  /** Called with the image that the canvas shows; null: the canvas is hidden. */
  readonly onShow: (image: Image | null) => void;
  readonly onFail?: (error: Error) => void;
}

/**
 * Keeps a layer on `canvas`, over the picture. The canvas is hidden while the picture moves and
 * shown again once the layer of the resting frame is made. Layers are made one at a time; the
 * newest request comes next. Returns a function that stops this.
 */
export function drawAtRest<Image extends LayerImage>(
  canvas: HTMLCanvasElement,
  viewer: Pick<Viewer, 'shownFrame'>,
  store: ViewerStore,
  { asked, make, onShow, onFail }: RestLayer<Image>,
): () => void {
  /** Key of the layer made last or in progress. */
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
