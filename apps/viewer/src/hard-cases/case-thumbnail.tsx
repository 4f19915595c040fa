import { useEffect, useRef } from 'react';
import type { CaseImages, ImageCase } from './case-images.ts';
import { ownPart } from './own-part.ts';

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
  useEffect(() => {
    const element = canvas.current;
    if (!element) return;
    const isGone = new AbortController();
    let isInView: AbortController | null = null;
    const draw = async (signal: AbortSignal) => {
      const [camera] = Object.values(hardCase.cameras(SIZE.widthPx / SIZE.heightPx));
      const how = { ...SIZE, preset: 'reference', rasterizer: 'quads' } as const;
      const ordinary = await images.ordinary(how);
      show(element, (await images.draw({ hardCase, camera, ...how }, signal)).data, ordinary.data);
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
      { root: element.closest('.gallery'), rootMargin: AHEAD },
    );
    observer.observe(element);
    return () => {
      observer.disconnect();
      isGone.abort();
    };
  }, [hardCase, images]);
  return (
    <span className="gallery-thumbnail" aria-hidden="true">
      <canvas ref={canvas} width={SIZE.widthPx} height={SIZE.heightPx} />
    </span>
  );
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
