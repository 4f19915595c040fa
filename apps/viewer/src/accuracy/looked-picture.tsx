import { useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import { drawLayer } from '../engine/draw-at-rest.ts';
import type { LayerImage } from '../state/frames.ts';
import type { ViewerStore } from '../state/store.ts';

/** The picture of the preset whose row is under the pointer, over the viewer's canvas. */
export function LookedPicture({ store }: { readonly store: ViewerStore }) {
  const image = useStore(store, ({ looked, judged, isIdle }) =>
    looked !== null && isIdle ? judged?.[looked]?.whole : undefined,
  );
  return image && <Pixels image={image} className="over-picture" testId="looked-picture" />;
}

/** A canvas with an image. */
export function Pixels({
  image,
  className,
  testId,
}: {
  readonly image: LayerImage;
  readonly className?: string;
  readonly testId?: string;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current) drawLayer(canvas.current, image);
  }, [image]);
  return <canvas ref={canvas} className={className} data-testid={testId} />;
}
