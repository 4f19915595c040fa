import { BLACK, type Pixels, shownBytes, stepsBetween } from '@websplatter/kit/shown-pixels';
import { useEffect, useRef, useState } from 'react';
import type { CaseImages, ImageCase, SizePx } from './case-images.ts';

/** A rectangle in a picture. */
interface Box extends SizePx {
  readonly leftPx: number;
  readonly topPx: number;
}

/** Channel differences in 8-bit steps: the least that counts, and the least with full colour. */
const SEEN_STEPS = 3;
const COLOURED_STEPS = 16;
/** Largest magnification of a small part. */
const MOST_MAGNIFIED = 5;
/** Margin on each side, as a fraction of the part's size. */
const MARGIN = 0.25;
/** Brightness of grey pixels. */
const DIMMED = 0.45;
/** Darker pictures are brightened until their brightest channel has this value. */
const LEAST_BRIGHTEST = 128;

/**
 * Highlights where a case's picture differs from the ordinary one. Other pixels become grey, and dark
 * pictures bright enough to be seen. `box` surrounds the coloured pixels, with the picture's aspect
 * ratio. If nothing or almost everything differs, `box` is the whole picture.
 *
 * @param own, ordinary premultiplied RGBA, 4·width·height values each, shown over black.
 */
export function ownPart(
  own: Pixels,
  ordinary: Pixels,
  { widthPx, heightPx }: SizePx,
): { readonly pixels: Uint8ClampedArray<ArrayBuffer>; readonly box: Box } {
  const pixels = shownBytes(own, BLACK);
  const steps = stepsBetween(own, ordinary, BLACK);
  let [left, top, right, bottom] = [widthPx, heightPx, 0, 0];
  for (let pixel = 0; pixel < widthPx * heightPx; pixel++) {
    const at = 4 * pixel;
    const color = pixels.subarray(at, at + 3);
    const grey = DIMMED * (0.21 * color[0] + 0.72 * color[1] + 0.07 * color[2]);
    const kept = Math.min(1, steps[pixel] / COLOURED_STEPS);
    color.set(color.map((channel) => grey + kept * (channel - grey)));
    if (steps[pixel] < SEEN_STEPS) continue;
    const [x, y] = [pixel % widthPx, Math.floor(pixel / widthPx)];
    [left, top] = [Math.min(left, x), Math.min(top, y)];
    [right, bottom] = [Math.max(right, x + 1), Math.max(bottom, y + 1)];
  }
  const brightest = pixels.reduce((most, byte, i) => (i % 4 === 3 ? most : Math.max(most, byte)), 1);
  const gain = Math.max(1, LEAST_BRIGHTEST / brightest);
  if (gain > 1) for (const [i, byte] of pixels.entries()) if (i % 4 !== 3) pixels[i] = gain * byte;
  const part = Math.max((right - left) / widthPx, (bottom - top) / heightPx) * (1 + 2 * MARGIN);
  if (part <= 0 || part >= 1) return { pixels, box: { leftPx: 0, topPx: 0, widthPx, heightPx } };
  const shown = Math.max(part, 1 / MOST_MAGNIFIED);
  const within = (center: number, size: number) =>
    Math.min(size - shown * size, Math.max(0, center - (shown * size) / 2));
  const box = {
    leftPx: within((left + right) / 2, widthPx),
    topPx: within((top + bottom) / 2, heightPx),
    widthPx: shown * widthPx,
    heightPx: shown * heightPx,
  };
  return { pixels, box };
}

/** Pixels of a thumbnail: twice its size in CSS pixels, for dense screens. */
const SIZE = { widthPx: 208, heightPx: 156 };
/** Thumbnails are drawn this far before they scroll into view. */
const AHEAD = '300px';

/**
 * The distinctive part of a case's picture from its first camera; drawn by this device once in
 * view.
 */
export function CaseThumbnail({ hardCase, images }: { hardCase: ImageCase; images: CaseImages }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [words, setWords] = useState<string | null>(null);
  useEffect(() => {
    const element = canvas.current;
    if (!element) return;
    const isGone = new AbortController();
    let isInView: AbortController | null = null;
    const draw = async (signal: AbortSignal) => {
      const [camera] = Object.values(hardCase.cameras(SIZE.widthPx / SIZE.heightPx));
      const how = { ...SIZE, preset: 'reference', rasterizer: 'quads' } as const;
      const ordinary = await images.ordinary(how);
      const own = await images.draw({ hardCase, camera, ...how }, signal);
      const nothing = wordsForNothing(own.data, ordinary.data);
      if (nothing === null) show(element, own.data, ordinary.data);
      else setWords(nothing);
      observer.disconnect();
    };
    const observer = new IntersectionObserver(
      (entries) => {
        isInView?.abort();
        if (!entries.at(-1)?.isIntersecting) return;
        isInView = new AbortController();
        // Without a GPU or a picture in time, the canvas stays empty: the case's page shows the
        // reason.
        draw(AbortSignal.any([isInView.signal, isGone.signal])).catch(() => {});
      },
      { rootMargin: AHEAD },
    );
    observer.observe(element);
    return () => {
      observer.disconnect();
      isGone.abort();
    };
  }, [hardCase, images]);
  return (
    <span className="gallery-thumbnail" aria-hidden="true">
      {words ?? <canvas ref={canvas} width={SIZE.widthPx} height={SIZE.heightPx} />}
    </span>
  );
}

/** Words in place of a picture that would be black, or grey all over; null for others. */
export function wordsForNothing(own: Pixels, ordinary: Pixels): string | null {
  if (shownBytes(own, BLACK).every((byte, i) => i % 4 === 3 || byte < SEEN_STEPS)) return 'nothing visible';
  const isOrdinary = stepsBetween(own, ordinary, BLACK).every((steps) => steps < SEEN_STEPS);
  return isOrdinary ? 'adds nothing visible' : null;
}

function show(canvas: HTMLCanvasElement, own: Float32Array, ordinary: Float32Array): void {
  const { widthPx, heightPx } = SIZE;
  const { pixels, box } = ownPart(own, ordinary, SIZE);
  const context = canvas.getContext('2d');
  if (!context) return;
  context.putImageData(new ImageData(pixels, widthPx, heightPx), 0, 0);
  context.imageSmoothingEnabled = false;
  const { leftPx, topPx } = box;
  context.drawImage(canvas, leftPx, topPx, box.widthPx, box.heightPx, 0, 0, widthPx, heightPx);
  canvas.dataset.drawn = '';
}
